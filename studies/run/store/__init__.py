"""The store: layout, records, atomic writes, and the hash of the sources that decide a result. No mechanics."""
