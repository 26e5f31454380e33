"""Names of fields, messages and enum values: their words, and the units that they speak of."""
