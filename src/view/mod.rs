//! The abstract picture: what is to be drawn and from where, with no graphics library and no physics.
