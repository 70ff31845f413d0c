//! Points inside cells: trilinear weights (J6).
