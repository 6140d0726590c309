"""The text of an interceptor keeps its contracts."""
