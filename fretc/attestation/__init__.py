"""Signatures and the software bill of materials.

Input is files, SSH keys and the list of trusted signers. Output is signed statements, the result of
checking them, and a CycloneDX document.
"""
