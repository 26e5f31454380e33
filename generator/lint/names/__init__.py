"""Names of fields, messages and enum values: split into words, and searched for units."""
