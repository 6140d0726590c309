"""TLSF, the exchange format of synthesis tools: its text, and requirements from its formulas.

Source: Jacobs, Klein, Schirmer, A high-level LTL synthesis format: TLSF v1.1, SYNT 2016. This is
the basic format: without parameters, definitions and buses.
"""
