"""Reports: pages and pictures as a function of stored tables.

This package turns a store into committed pages. It reads JSON and CSV and nothing else: nothing of ``formulations``,
``contact`` or ``studies`` is imported here, and nothing is solved. Sentences that contain results are computed.
"""
