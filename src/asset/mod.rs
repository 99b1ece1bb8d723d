//! The bytes of files to values: bounded in time and memory, whatever the bytes.

pub mod image;
pub mod mesh;
pub mod table;

pub use image::Image;
pub use mesh::Mesh;
