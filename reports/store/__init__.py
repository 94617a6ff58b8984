"""What the reports read: records and tables of a store, checked. Nothing is computed or written here."""
