"""Fix-its: the declarations and edits that help texts suggest, as the user has to write them in a .proto file."""
