"""Names of fields, messages and enum values: their words and units."""
