//! What is measured: scenes that stand alone, and texts to read.

// Each benchmark is a crate, and takes of these what it needs.
#![allow(dead_code, reason = "no benchmark uses all of them")]

use rt_lang::files::{FileError, FilePath, Files};
use rt_lang::scene::Scene;
use rt_lang::source::{Source, Sources};
use rt_lang::{Options, compile};
use std::fmt::Write;
use std::sync::Arc;

/// A room with a lamp, and in it balls of all materials.
pub const ROOM: &str = "
    box { size: (4, 3, 4)m, at: (0, 1.5, 0)m, material: diffuse { color: #b0a090 } }
    sphere { at: (0, 2.4, 0)m, radius: 20cm, material: emitter { power: 60W } }
    sphere { at: (-1, 0.4, -0.5)m, radius: 40cm, material: mirror { } }
    sphere { at: (0, 0.4, -1)m, radius: 40cm, material: dielectric { ior: 1.5 } }
    sphere { at: (1, 0.4, -0.5)m, radius: 40cm, material: metal { color: #c9a227, roughness: 30% } }
    sphere { at: (0.5, 0.3, 0.4)m, radius: 30cm, material: plastic { color: #d94f30, roughness: 20% } }
    sphere { at: (-0.5, 0.2, 0.5)m, radius: 20cm, material: diffuse { color: #3060a0 } }
    camera { from: (0, 1.5, 1.9)m, look: (0, 0.8, -0.5)m, fov: 70deg }
";

/// Balls on a plain under a sky.
pub fn balls(count: u32) -> String {
    let side = f64::from(count).sqrt() * 0.03;
    format!(
        "plane {{ }}
         sky {{ color: #c0d0ff }}
         let side = {side:?}m
         for i in range({count}) {{
           sphere {{ at: (side * (rand(i, 0) - 0.5), 2cm, side * (rand(i, 1) - 0.5)), radius: 12mm }}
         }}
         camera {{ from: (0, side / 4, side), look: (0, 0, 0)m }}"
    )
}

/// There is no other file to read.
struct Alone;

impl Files for Alone {
    fn read(&self, _: &FilePath, _: usize) -> Result<Arc<[u8]>, FileError> {
        Ok(Arc::new([]))
    }
}

/// The scene of a text that stands alone.
pub fn scene(text: &str) -> Scene {
    let mut sources = Sources::default();
    let main = sources.add(Source::new("bench.rt", text));
    let compiled = compile(&Alone, &mut sources, main, &Options::default());
    compiled.scene.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics))
}

/// Numbers that look random and are the same every time: the linear congruence of Knuth's MMIX.
pub struct Numbers(pub u64);

impl Numbers {
    /// Below 2²⁴.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 40
    }

    /// Hundredths from −5 to 5.
    pub fn metres(&mut self) -> f64 {
        (self.next() % 1001) as f64 / 100.0 - 5.0
    }
}

/// Spheres one by one, each with what may be written of its material.
pub fn spheres(count: usize, material: impl Fn(&mut Numbers) -> String) -> String {
    let (mut text, mut numbers) = (String::new(), Numbers(1));
    for _ in 0..count {
        let (x, y, z) = (numbers.metres(), numbers.metres(), numbers.metres());
        let (radius, material) = (1 + numbers.next() % 99, material(&mut numbers));
        writeln!(text, "sphere {{ at: ({x:.2}, {y:.2}, {z:.2})m, radius: {radius}mm{material} }}")
            .expect("a string takes any text");
    }
    text
}
