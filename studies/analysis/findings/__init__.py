"""What the pages say about which measure and which contact algorithm: failures, regimes, and the price of accuracy."""
