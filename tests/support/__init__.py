"""Functions that the tests share; they are imported, fixtures stay in conftest.py."""
