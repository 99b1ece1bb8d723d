//! Triangle meshes: from PLY and OBJ files, made sound.

mod obj;
mod ply;

use crate::math::{DVec2, DVec3, atan2};

/// The most triangles a mesh may have.
pub const MOST_TRIANGLES: usize = 10_000_000;

/// The most vertices of a mesh: more cannot be of use.
pub const MOST_VERTICES: usize = 3 * MOST_TRIANGLES;

/// Coordinates beyond this would leave the range of numbers when they are multiplied.
const FARTHEST: f64 = 1e50;

/// A surface of triangles in the space of its file.
///
/// Every index is in range, every triangle has an area, and every number is finite. A closed mesh has its triangles
/// oriented outwards, as a whole.
#[derive(Clone, Debug)]
pub struct Mesh {
    positions: Vec<DVec3>,
    /// Unit vectors, one a position, on the side that the triangles face.
    normals: Vec<DVec3>,
    /// One a position; empty where the file has none.
    uvs: Vec<DVec2>,
    /// Indices of positions, counterclockwise seen from outside.
    triangles: Vec<[u32; 3]>,
    closed: bool,
    /// Least and greatest coordinates of its triangles.
    extent: [DVec3; 2],
    hash: blake3::Hash,
}

/// What a file says, before it is known to be sound.
#[derive(Default)]
struct Raw {
    positions: Vec<DVec3>,
    /// As many as there are positions, or none.
    normals: Vec<DVec3>,
    /// As many as there are positions, or none.
    uvs: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Reads a PLY file, which says that it is one, or else an OBJ file.
    ///
    /// # Errors
    ///
    /// In words that follow the file's name.
    pub fn decode(bytes: &[u8]) -> Result<Mesh, String> {
        Mesh::new(if bytes.starts_with(b"ply") { ply::read(bytes)? } else { obj::read(bytes)? })
    }

    fn new(raw: Raw) -> Result<Mesh, String> {
        let Raw { positions, normals, uvs, mut triangles } = raw;
        if positions.iter().any(|p| !p.is_finite() || p.abs().max_element() >= FARTHEST) {
            return Err("has a vertex that is not finite".into());
        }
        if triangles.iter().flatten().any(|&corner| corner as usize >= positions.len()) {
            return Err("has a face with a vertex that is not there".into());
        }
        // Vertices at one place are one, however often the file lists them for their normals.
        let places = places(&positions);
        let apart = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|corner| places[corner as usize]);
            a != b && b != c && c != a
        };
        triangles.retain(apart);
        let closed = is_closed(&triangles, &places);
        let cross = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|corner| positions[corner as usize]);
            (b - a).cross(c - a)
        };
        triangles.retain(|t| cross(t).length_squared().is_normal());
        if triangles.is_empty() {
            return Err("has no triangle with an area".into());
        }
        let origin = positions[triangles[0][0] as usize];
        let volume: f64 = triangles.iter().map(|t| cross(t).dot(positions[t[0] as usize] - origin)).sum();
        if closed && volume < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let given = normals.iter().map(|n| n.length_squared()).all(|squared| squared.is_normal());
        let normals = match given && !normals.is_empty() {
            true => turned(normals, &triangles, &cross),
            false => smoothed(&positions, &triangles, &places),
        };
        let uvs = if uvs.iter().all(|uv| uv.is_finite()) { uvs } else { vec![] };
        let corners = || triangles.iter().flatten().map(|&corner| positions[corner as usize]);
        let extent =
            [corners().fold(DVec3::INFINITY, DVec3::min), corners().fold(DVec3::NEG_INFINITY, DVec3::max)];
        let hash = blake3::Hash::from([0; 32]);
        let mut mesh = Mesh { positions, normals, uvs, triangles, closed, extent, hash };
        mesh.hash = mesh.digest();
        Ok(mesh)
    }

    /// How many triangles it has.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// How many bytes of memory it takes.
    pub fn bytes(&self) -> usize {
        let vectors = size_of_val(&self.positions[..]) + size_of_val(&self.normals[..]);
        vectors + size_of_val(&self.uvs[..]) + size_of_val(&self.triangles[..])
    }

    /// Whether it has no triangle, which never is.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The corners of a triangle, counterclockwise seen from outside.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    /// Unit normals for the corners of a triangle: the file's, or else means of the triangles around.
    pub fn normals(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.normals[corner as usize])
    }

    /// Places in a picture for the corners of a triangle, where the file has them.
    pub fn uvs(&self, triangle: u32) -> Option<[DVec2; 3]> {
        let corners = self.triangles[triangle as usize];
        (!self.uvs.is_empty()).then(|| corners.map(|corner| self.uvs[corner as usize]))
    }

    /// Whether it bounds a solid: each edge is shared by two triangles that are oriented alike.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Least and greatest coordinates.
    pub fn extent(&self) -> [DVec3; 2] {
        self.extent
    }

    /// Of all that it holds.
    pub fn hash(&self) -> blake3::Hash {
        self.hash
    }

    fn digest(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        let mut number = |x: f64| {
            hasher.update(&x.to_le_bytes());
        };
        for points in [&self.positions, &self.normals] {
            number(points.len() as f64);
            points.iter().flat_map(|p| p.to_array()).for_each(&mut number);
        }
        self.uvs.iter().flat_map(|uv| uv.to_array()).for_each(&mut number);
        self.triangles.iter().flatten().for_each(|corner| {
            hasher.update(&corner.to_le_bytes());
        });
        hasher.finalize()
    }
}

/// Equal content is the same mesh.
impl PartialEq for Mesh {
    fn eq(&self, other: &Mesh) -> bool {
        self.hash == other.hash
    }
}

/// For each position the first index of one at the same place.
fn places(positions: &[DVec3]) -> Vec<u32> {
    // Adding zero makes the negative one positive.
    let key = |i: u32| (positions[i as usize] + 0.0).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut places = vec![0; positions.len()];
    let mut first = 0;
    for &i in &order {
        if key(i) != key(first) || i == order[0] {
            first = i;
        }
        places[i as usize] = first;
    }
    places
}

/// Whether each edge is there once in each direction.
fn is_closed(triangles: &[[u32; 3]], places: &[u32]) -> bool {
    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(3 * triangles.len());
    for t in triangles {
        let [a, b, c] = t.map(|corner| places[corner as usize]);
        edges.extend([[a, b], [b, c], [c, a]]);
    }
    edges.sort_unstable();
    let once = edges.windows(2).all(|pair| pair[0] != pair[1]);
    once && edges.iter().all(|[a, b]| edges.binary_search(&[*b, *a]).is_ok())
}

/// The file's normals at length 1, all of them turned over where they point against the triangles as a whole.
fn turned(normals: Vec<DVec3>, triangles: &[[u32; 3]], cross: &dyn Fn(&[u32; 3]) -> DVec3) -> Vec<DVec3> {
    let along = |t: &[u32; 3]| {
        let n = cross(t);
        t.iter().map(|&corner| n.dot(normals[corner as usize])).sum::<f64>()
    };
    let sign = if triangles.iter().map(along).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    normals.iter().map(|n| sign * n.normalize()).collect()
}

/// Normals as means of those of the triangles around a place, weighed by their angles there (Thürmer and Wüthrich,
/// "Computing vertex normals from polygonal facets", 1998).
fn smoothed(positions: &[DVec3], triangles: &[[u32; 3]], places: &[u32]) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for t in triangles {
        let corners = t.map(|corner| positions[corner as usize]);
        let n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        for i in 0..3 {
            let u = corners[(i + 1) % 3] - corners[i];
            let v = corners[(i + 2) % 3] - corners[i];
            let angle = atan2(u.cross(v).length(), u.dot(v));
            sums[places[t[i] as usize] as usize] += angle * n;
        }
    }
    // Where triangles face each other back to back there is no mean, and whoever shades takes the triangle's own.
    places.iter().map(|&place| sums[place as usize].normalize_or_zero()).collect()
}

#[cfg(test)]
mod tests;
