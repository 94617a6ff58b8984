"""Reference solutions by equations of their own. No element, no contact algorithm, no scene enters here."""
