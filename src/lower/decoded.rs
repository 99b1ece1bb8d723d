//! Meshes and pictures as they were decoded, for the next scene that reads the same files.

use crate::asset::{Image, Mesh};
use crate::files::FilePath;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// What became of files, as long as they hold the same bytes.
#[derive(Default)]
pub struct Decoded {
    meshes: Kept<Mesh>,
    images: Kept<Image>,
}

/// By path: the bytes, and what they are or why they are not.
type Kept<T> = Mutex<BTreeMap<FilePath, (Arc<[u8]>, Result<Arc<T>, String>)>>;

impl Decoded {
    /// The mesh of a file.
    pub(super) fn mesh(&self, path: &FilePath, bytes: &Arc<[u8]>) -> Result<Arc<Mesh>, String> {
        once(&self.meshes, path, bytes, Mesh::decode)
    }

    /// The picture of a file.
    pub(super) fn image(&self, path: &FilePath, bytes: &Arc<[u8]>) -> Result<Arc<Image>, String> {
        once(&self.images, path, bytes, |bytes| Image::decode(bytes).map_err(|error| error.to_string()))
    }
}

fn once<T>(
    kept: &Kept<T>,
    path: &FilePath,
    bytes: &Arc<[u8]>,
    decode: impl FnOnce(&[u8]) -> Result<T, String>,
) -> Result<Arc<T>, String> {
    // An entry is whole or not there.
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    match kept.get(path) {
        Some((known, found)) if Arc::ptr_eq(known, bytes) => found.clone(),
        _ => {
            let found = decode(bytes).map(Arc::new);
            kept.insert(path.clone(), (bytes.clone(), found.clone()));
            found
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_bytes_are_decoded_once() {
        let decoded = Decoded::default();
        let path = FilePath::root("a.ply");
        let bytes: Arc<[u8]> = b"no mesh".as_slice().into();
        let mut count = 0;
        for bytes in [bytes.clone(), bytes.clone(), b"no mesh".as_slice().into()] {
            let found = once(&decoded.meshes, &path, &bytes, |_| {
                count += 1;
                Err("is no mesh".into())
            });
            assert!(found.is_err());
        }
        assert_eq!(count, 2, "other bytes are decoded anew, also where they are equal");
    }
}
