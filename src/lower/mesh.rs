//! Meshes: files to triangles, each file read once.

use super::decoded::Decoded;
use super::errors;
use super::shape::placed;
use crate::asset::Mesh;
use crate::asset::mesh::MOST_TRIANGLES;
use crate::diagnostic::Diagnostic;
use crate::eval::{Thing, Things};
use crate::files::{Contents, FileError, FilePath, Files};
use crate::math::{DAffine3, DVec3};
use crate::scene::Shape;
use crate::scene::shape::Instance;
use crate::schema::mesh;
use crate::source::Sources;
use crate::span::Span;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most bytes a mesh's file may have.
const MAX_FILE: usize = 1 << 28;

/// The meshes of a scene, read when they are first asked for.
pub struct Meshes<'f> {
    files: &'f dyn Files,
    sources: &'f Sources,
    pub(super) decoded: &'f Decoded,
    read: RefCell<Read>,
}

#[derive(Default)]
struct Read {
    /// What became of each file that was asked for; else why it is no mesh.
    files: BTreeMap<FilePath, Result<Arc<Mesh>, String>>,
    triangles: usize,
}

impl<'f> Meshes<'f> {
    /// None yet. The paths in `sources` are relative to each source's own.
    pub fn new(files: &'f dyn Files, sources: &'f Sources, decoded: &'f Decoded) -> Meshes<'f> {
        Meshes { files, sources, decoded, read: RefCell::default() }
    }

    /// Says where they were read.
    pub(super) fn name(&self, contents: &mut Contents) {
        for (path, found) in &self.read.borrow().files {
            if let Ok(mesh) = found {
                contents.add(mesh.hash(), path);
            }
        }
    }

    /// Lowers a mesh.
    pub(super) fn lower(&self, things: &Things, thing: &Thing) -> Result<Shape, Box<Diagnostic>> {
        let made = thing.made;
        let file = things.read(made, mesh::FILE);
        let span = made.given(mesh::FILE).map_or(made.span(), |(_, span)| span);
        let triangles = self.file(&file, span)?;
        let unit = DVec3::splat(things.read(made, mesh::UNIT));
        let placed = placed(thing.world_from_object * DAffine3::from_scale(unit), made.span())?;
        let smooth = things.read(made, mesh::SMOOTH);
        let shape = Shape::Mesh(Box::new(Instance::new(triangles, placed, smooth)));
        match shape.bounds().is_some_and(|bounds| bounds.size().is_finite()) {
            true => Ok(shape),
            false => Err(Box::new(errors::too_large(made.span()))),
        }
    }

    fn file(&self, file: &str, span: Span) -> Result<Arc<Mesh>, Box<Diagnostic>> {
        let refuse = |error: FileError| Box::new(error.diagnostic(file, span));
        let path = self.sources.get(span.source).path.join(file).map_err(refuse)?;
        let mut read = self.read.borrow_mut();
        let found = match read.files.get(&path) {
            Some(found) => found.clone(),
            None => {
                let bytes = self.files.read(&path, MAX_FILE).map_err(refuse)?;
                let found = self.decoded.mesh(&path, &bytes);
                read.triangles += found.as_ref().map_or(0, |mesh| mesh.len());
                read.files.insert(path, found.clone());
                found
            }
        };
        if read.triangles > MOST_TRIANGLES {
            return Err(Box::new(errors::too_many_triangles(MOST_TRIANGLES, span)));
        }
        found.map_err(|why| Box::new(errors::no_mesh(file, &why, span)))
    }
}
