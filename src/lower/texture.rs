//! Textures: written values to entries of the scene, files to pictures, each once.

use super::decoded::Decoded;
use super::errors;
use crate::asset::Image;
use crate::diagnostic::Diagnostic;
use crate::eval::{self, Given, Pattern, Read};
use crate::files::{Contents, FileError, FilePath, Files};
use crate::math::DVec2;
use crate::scene::{ImageId, Paint, Texture, TextureId};
use crate::schema;
use crate::source::Sources;
use crate::span::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most bytes a picture's file may have.
const MAX_FILE: usize = 1 << 28;

/// The most pixels all pictures of a scene may have together; each takes twelve bytes.
const MAX_PIXELS: u64 = 1 << 27;

/// The textures and pictures of a scene, each once.
pub(super) struct Textures<'f> {
    files: &'f dyn Files,
    sources: &'f Sources,
    decoded: &'f Decoded,
    textures: Vec<Texture>,
    /// By canonical bytes.
    known: BTreeMap<Vec<u8>, TextureId>,
    images: Vec<Arc<Image>>,
    /// What became of each file that was asked for; else why it is no picture.
    read: BTreeMap<FilePath, Result<ImageId, String>>,
}

impl<'f> Textures<'f> {
    pub(super) fn new(files: &'f dyn Files, sources: &'f Sources, decoded: &'f Decoded) -> Textures<'f> {
        Textures {
            files,
            sources,
            decoded,
            textures: vec![],
            known: BTreeMap::new(),
            images: vec![],
            read: BTreeMap::new(),
        }
    }

    /// Says where the pictures were read.
    pub(super) fn name(&self, contents: &mut Contents) {
        for (path, found) in &self.read {
            if let Ok(image) = found {
                contents.add(self.images[image.0 as usize].hash(), path);
            }
        }
    }

    pub(super) fn finish(self) -> (Vec<Texture>, Vec<Arc<Image>>) {
        (self.textures, self.images)
    }

    /// Lowers a colour or texture, no channel of which may be above `most`.
    pub(super) fn paint(&mut self, paint: &eval::Paint, most: f64) -> Result<Paint, Box<Diagnostic>> {
        match paint {
            eval::Paint::Plain(color) => Ok(Paint::Plain(*color)),
            eval::Paint::Texture(texture) => self.texture(texture, most).map(Paint::Texture),
        }
    }

    fn texture(&mut self, texture: &eval::Texture, most: f64) -> Result<TextureId, Box<Diagnostic>> {
        let [a, b] = match &texture.parts {
            Some([a, b]) => [self.part(a, most)?, self.part(b, most)?],
            None => [Paint::Plain(crate::color::Rgb::ZERO); 2],
        };
        let lowered = match &texture.pattern {
            Pattern::Checker(size) => Texture::Checker { a, b, size: *size },
            Pattern::Stripes(width, along) => {
                // Its length was seen not to be 0.
                let along = super::shape::unit(*along).unwrap_or(*along);
                Texture::Stripes { a, b, width: *width, along }
            }
            Pattern::Noise(size, octaves, seed) => {
                Texture::Noise { a, b, size: *size, octaves: *octaves, seed: *seed }
            }
            Pattern::Image(file, span, width) => {
                let image = self.image(file, *span)?;
                let picture = &self.images[image.0 as usize];
                if picture.peak() > most {
                    return Err(Box::new(errors::too_bright(file, picture.peak(), *span)));
                }
                let aspect = f64::from(picture.height()) / f64::from(picture.width());
                Texture::Image { image, size: DVec2::new(*width, *width * aspect) }
            }
        };
        let key = postcard::to_stdvec(&lowered).expect("a texture is plain numbers");
        Ok(*self.known.entry(key).or_insert_with(|| {
            self.textures.push(lowered);
            TextureId(self.textures.len() as u32 - 1)
        }))
    }

    fn part(&mut self, part: &Given, most: f64) -> Result<Paint, Box<Diagnostic>> {
        let paint = schema::Paint::read(&part.value).expect("a texture is made of what was checked");
        self.paint(&paint, most)
    }

    /// The picture of a file, named as the scene names it.
    pub(super) fn image(&mut self, file: &str, span: Span) -> Result<ImageId, Box<Diagnostic>> {
        let refuse = |error: FileError| Box::new(error.diagnostic(file, span));
        let path = self.sources.get(span.source).path.join(file).map_err(refuse)?;
        let found = match self.read.get(&path) {
            Some(found) => found.clone(),
            None => {
                let bytes = self.files.read(&path, MAX_FILE).map_err(refuse)?;
                let found = self.decoded.image(&path, &bytes).map(|image| self.add(image));
                self.read.insert(path, found.clone());
                found
            }
        };
        let id = found.map_err(|why| Box::new(errors::no_picture(file, &why, span)))?;
        let pixels: u64 = self.images.iter().map(|image| image.pixels()).sum();
        if pixels > MAX_PIXELS {
            return Err(Box::new(errors::too_many_texels(MAX_PIXELS, span)));
        }
        Ok(id)
    }

    /// Two files may hold the same picture.
    fn add(&mut self, image: Arc<Image>) -> ImageId {
        let place = self.images.iter().position(|known| *known == image).unwrap_or_else(|| {
            self.images.push(image);
            self.images.len() - 1
        });
        ImageId(place as u32)
    }
}
