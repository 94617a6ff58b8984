"""Every sentence of conclusion that the pages make, as a row of a table: its words, its numbers, what it rests on."""
