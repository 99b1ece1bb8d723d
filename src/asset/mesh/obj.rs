//! OBJ files: all their groups as one mesh.

use super::{MOST_TRIANGLES, Raw};
use crate::math::{DVec2, DVec3};
use tobj::{LoadError, LoadOptions};

/// Reads vertices and faces; lines and points are left out, and materials are the scene's.
pub(super) fn read(bytes: &[u8]) -> Result<Raw, String> {
    // A face of eight bytes takes ten times as many once it is read.
    if bytes.split(|byte| *byte == b'\n').filter(|line| line.starts_with(b"f ")).count() > MOST_TRIANGLES {
        return Err(format!("has more than {MOST_TRIANGLES} faces"));
    }
    let options =
        LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let no_materials = |_: &std::path::Path| Err(LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut &*bytes, &options, no_materials)
        .map_err(|error| format!("is no sound PLY or OBJ file: {error}"))?;
    let mut raw = Raw::default();
    let with = |has: fn(&tobj::Mesh) -> bool| models.iter().all(|model| has(&model.mesh));
    let (normals, uvs) = (with(|mesh| !mesh.normals.is_empty()), with(|mesh| !mesh.texcoords.is_empty()));
    for mesh in models.iter().map(|model| &model.mesh) {
        let base = raw.positions.len() as u32;
        raw.positions.extend(triples(&mesh.positions));
        if normals {
            raw.normals.extend(triples(&mesh.normals));
        }
        if uvs {
            raw.uvs.extend(mesh.texcoords.chunks_exact(2).map(DVec2::from_slice));
        }
        raw.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [base + t[0], base + t[1], base + t[2]]));
        if raw.triangles.len() > MOST_TRIANGLES {
            return Err(format!("has more than {MOST_TRIANGLES} triangles"));
        }
    }
    let count = raw.positions.len();
    raw.normals = if raw.normals.len() == count { raw.normals } else { vec![] };
    raw.uvs = if raw.uvs.len() == count { raw.uvs } else { vec![] };
    Ok(raw)
}

fn triples(numbers: &[f64]) -> impl Iterator<Item = DVec3> {
    numbers.chunks_exact(3).map(DVec3::from_slice)
}
