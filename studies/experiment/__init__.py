"""The experiment: its figures, its claims, and what lies behind them."""
