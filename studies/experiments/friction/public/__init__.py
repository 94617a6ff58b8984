"""Problems with friction of others, and random ones, before all algorithms. No scene may enter here."""
