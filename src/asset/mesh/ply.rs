//! PLY files: text and binary, of either order of bytes.

use super::{MOST_TRIANGLES, MOST_VERTICES, Raw};
use crate::math::{DVec2, DVec3};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

/// Reads vertices and faces; faces with more than three corners become fans.
pub(super) fn read(bytes: &[u8]) -> Result<Raw, String> {
    let refuse = |error: ply_rs_bw::parser::ParseError| format!("is no sound PLY file: {error}");
    let mut reader = Reader::new(bytes);
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(refuse)?;
    let mut raw = Raw::default();
    for (_, element) in &header.elements {
        fits(element, &header, bytes.len())?;
        match element.name.as_str() {
            "vertex" => {
                within(element, MOST_VERTICES, "vertices")?;
                let parser = Parser::<Vertex>::new();
                let vertices = parser.read_payload_for_element(&mut reader, element, &header);
                take_vertices(&vertices.map_err(refuse)?, element, &mut raw)?;
            }
            "face" => {
                within(element, MOST_TRIANGLES, "faces")?;
                let parser = Parser::<Face>::new();
                let faces = parser.read_payload_for_element(&mut reader, element, &header);
                take_faces(&faces.map_err(refuse)?, &mut raw)?;
            }
            _ => {
                let parser = Parser::<Skipped>::new();
                let skipped = parser.read_payload_for_element(&mut reader, element, &header);
                skipped.map_err(refuse)?;
            }
        }
    }
    Ok(raw)
}

/// The header's counts are believed only as far as the file is long enough to hold so many.
fn fits(element: &ElementDef, header: &Header, bytes: usize) -> Result<(), String> {
    let size = |ty: &ScalarType| match ty {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let least = |ty: &PropertyType| match (&header.encoding, ty) {
        (Encoding::Ascii, _) => 2,
        (_, PropertyType::Scalar(ty) | PropertyType::List(ty, _)) => size(ty),
    };
    let each: usize = element.properties.iter().map(|(_, property)| least(&property.data_type)).sum();
    // The last line of a text may end with the file.
    if element.count.saturating_mul(each.max(1)) > bytes.saturating_add(1) {
        return Err(format!(
            "is no sound PLY file: it is too short for {} × {}",
            element.count, element.name
        ));
    }
    Ok(())
}

/// What a few bytes stand for in the file is much larger once it is read.
fn within(element: &ElementDef, most: usize, what: &str) -> Result<(), String> {
    if element.count <= most { Ok(()) } else { Err(format!("has more than {most} {what}")) }
}

fn take_vertices(vertices: &[Vertex], element: &ElementDef, raw: &mut Raw) -> Result<(), String> {
    let has = |names: &[&str]| names.iter().all(|name| element.properties.iter().any(|(key, _)| key == name));
    if !has(&["x", "y", "z"]) {
        return Err("is a PLY file whose vertices lack x, y or z".into());
    }
    raw.positions = vertices.iter().map(|vertex| vertex.p).collect();
    if has(&["nx", "ny", "nz"]) {
        raw.normals = vertices.iter().map(|vertex| vertex.n).collect();
    }
    if has(&["u", "v"]) || has(&["s", "t"]) || has(&["texture_u", "texture_v"]) {
        raw.uvs = vertices.iter().map(|vertex| vertex.uv).collect();
    }
    Ok(())
}

fn take_faces(faces: &[Face], raw: &mut Raw) -> Result<(), String> {
    for Face { corners } in faces {
        if raw.triangles.len() + corners.len().saturating_sub(2) > MOST_TRIANGLES {
            return Err(format!("has more than {MOST_TRIANGLES} triangles"));
        }
        for pair in corners.get(1..).unwrap_or_default().windows(2) {
            raw.triangles.push([corners[0], pair[0], pair[1]]);
        }
    }
    Ok(())
}

struct Vertex {
    p: DVec3,
    n: DVec3,
    uv: DVec2,
}

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex { p: DVec3::ZERO, n: DVec3::ZERO, uv: DVec2::ZERO }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let place = match name {
            "x" => &mut self.p.x,
            "y" => &mut self.p.y,
            "z" => &mut self.p.z,
            "nx" => &mut self.n.x,
            "ny" => &mut self.n.y,
            "nz" => &mut self.n.z,
            "u" | "s" | "texture_u" => &mut self.uv.x,
            "v" | "t" | "texture_v" => &mut self.uv.y,
            _ => return PropertyAccessResult::Ignored,
        };
        match number(&property) {
            Some(value) => {
                *place = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

fn number(property: &Property) -> Option<f64> {
    Some(match property {
        Property::Char(v) => f64::from(*v),
        Property::UChar(v) => f64::from(*v),
        Property::Short(v) => f64::from(*v),
        Property::UShort(v) => f64::from(*v),
        Property::Int(v) => f64::from(*v),
        Property::UInt(v) => f64::from(*v),
        Property::Float(v) => f64::from(*v),
        Property::Double(v) => *v,
        _ => return None,
    })
}

struct Face {
    corners: Vec<u32>,
}

impl PropertyAccess for Face {
    fn new() -> Face {
        Face { corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        match property.to_u32_list() {
            Some(corners) => {
                self.corners = corners;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

/// An element that is of no use here.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Skipped {
        Skipped
    }
}
