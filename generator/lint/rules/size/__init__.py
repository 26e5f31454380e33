"""Rules about the size of messages on microcontrollers."""
