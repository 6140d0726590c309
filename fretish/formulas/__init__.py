"""Requirements as formulas of linear temporal logic.

`the NAME shall satisfy formula: F G a`: they state what no sentence of FRETish states.
"""
