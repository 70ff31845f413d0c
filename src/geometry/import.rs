//! Model files to meshes: OBJ through tobj (J1).
