//! The same bits on processors that this machine is not: other x86-64 ones, and an ARM with NEON, by emulation.

use super::{Outcome, Place, run, tools};
use std::fs;
use std::path::Path;
use std::process::Command;

/// x86-64 processors, each with other vector instructions: SSE4.2, AVX2, and whatever the emulator has.
const X86: &[&str] = &["Nehalem", "Haswell", "max"];
const ARM: &str = "aarch64-unknown-linux-gnu";
/// Small pictures that between them go through lanes, hierarchy, glass, textures and filters.
const SCENES: &[&str] = &[
    "examples/three-balls.rt",
    "examples/newton.rt",
    "examples/one-weekend.rt",
    "examples/hyperboloid-tower.rt",
];

/// Renders small pictures here and on other x86-64 processors, and compares their files byte by byte.
pub fn same_bits(place: &Place) -> Outcome {
    tools::emulators()?;
    for cpu in X86 {
        compare(place, cpu, "qemu-x86_64", &["-cpu", cpu], &place.rtc)?;
    }
    Ok(())
}

/// The same on an ARM.
pub fn same_bits_on_arm(place: &Place) -> Outcome {
    tools::emulators()?;
    tools::arm()?;
    let target = place.rtc.parent().and_then(Path::parent).ok_or("the command is in no target folder")?;
    run(Command::new("cargo")
        .args(["build", "--quiet", "--bin", "rtc", "--target", ARM])
        .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", tools::ARM_LINKER)
        .current_dir(&place.root))?;
    let arm = target.join(ARM).join("debug/rtc");
    compare(place, "NEON", "qemu-aarch64", &["-L", "/usr/aarch64-linux-gnu"], &arm)
}

/// Compares the pictures of an emulated processor with those of this one.
fn compare(place: &Place, name: &str, emulator: &str, flags: &[&str], rtc: &Path) -> Outcome {
    for scene in SCENES {
        let scene = place.root.join(scene);
        let native = rendered(place, Command::new(&place.rtc), &scene, "native")?;
        let mut emulated = Command::new(emulator);
        emulated.args(flags).arg(rtc);
        if rendered(place, emulated, &scene, name)? != native {
            return Err(format!("{} has other bytes on {name}", scene.display()));
        }
    }
    Ok(())
}

/// The bytes of a small picture.
fn rendered(place: &Place, mut rtc: Command, scene: &Path, name: &str) -> Result<Vec<u8>, String> {
    let picture = place.desk.join(format!("{name}.exr"));
    run(rtc.arg("build").arg(scene).args(["--size", "32x24", "--samples", "2", "-o"]).arg(&picture))?;
    fs::read(&picture).map_err(|error| format!("{}: {error}", picture.display()))
}
