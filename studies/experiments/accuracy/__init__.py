"""Experiments on accuracy and its price: what is enough, how honest stated errors are, which grid. No page enters."""
