"""Light and truth; importing this room loads no renderer."""
