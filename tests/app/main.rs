//! The window and its content: the panels by the names a screen reader says, the hand without a window, the worker thread
//! with sandboxes that are slow or broken, and the real program under a virtual display.

mod assistant;
mod files;
mod input;
mod live;
mod panels;
mod panels_bodies;
mod panels_brush;
mod panels_cost;
mod panels_error;
mod panels_fit;
mod panels_material;
mod panels_modes;
mod panels_motion;
mod panels_parts;
mod panels_pictures;
mod panels_places;
mod panels_sides;
mod panels_sizes;
mod panels_sliders;
mod panels_stability;
mod panels_things;
mod panels_untouched;
mod panels_values;
mod panels_within;
mod shot;
mod window;
mod window_dialogs;
mod window_files;
mod window_killed;
mod window_places;
mod window_speed;
mod worker;
mod worker_stop;
