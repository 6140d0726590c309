"""Monitor, interceptor and environment in closed loop."""
