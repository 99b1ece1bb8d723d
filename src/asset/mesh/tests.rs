use super::*;

/// A tetrahedron about the origin, oriented outwards.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 4\nproperty list uchar int vertex_indices\nend_header\n\
    1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n";

const OBJ: &str = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

fn outwards(mesh: &Mesh) -> bool {
    (0..mesh.len() as u32).all(|i| {
        let [a, b, c] = mesh.corners(i);
        (b - a).cross(c - a).dot(a) > 0.0 && mesh.normals(i).iter().all(|n| n.dot(a + b + c) > 0.0)
    })
}

#[test]
fn both_formats_give_the_same_mesh() {
    let (ply, obj) = (Mesh::decode(PLY.as_bytes()).unwrap(), Mesh::decode(OBJ.as_bytes()).unwrap());
    assert!(ply == obj && ply.is_closed() && ply.len() == 4 && outwards(&ply));
    assert!((ply.normals(0)[0] - DVec3::ONE.normalize()).length() < 1e-12);
}

#[test]
fn closed_meshes_are_turned_outwards_and_open_ones_left() {
    let inside_out = OBJ.replace("f 1 2 3", "f 1 3 2").replace("f 1 4 2", "f 1 2 4");
    let inside_out = inside_out.replace("f 1 3 4", "f 1 4 3").replace("f 2 4 3", "f 2 3 4");
    let mesh = Mesh::decode(inside_out.as_bytes()).unwrap();
    assert!(mesh.is_closed() && outwards(&mesh));
    assert!(!Mesh::decode(OBJ.replace("f 2 4 3\n", "").as_bytes()).unwrap().is_closed());
    // One face turned over: no orientation is right for all.
    assert!(!Mesh::decode(OBJ.replace("f 2 4 3", "f 2 3 4").as_bytes()).unwrap().is_closed());
}

#[test]
fn corners_that_are_listed_twice_close_a_mesh_all_the_same() {
    let apart = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\n\
        f 1 2 3\nf 1 4 5\nf 1 6 7\nf 2 4 6\n";
    let mesh = Mesh::decode(apart.as_bytes()).unwrap();
    assert!(mesh.is_closed() && outwards(&mesh));
}

#[test]
fn what_is_no_mesh_is_refused_with_a_reason() {
    for (bytes, words) in [
        (&b""[..], "no triangle"),
        (b"hello", "no "),
        (b"ply\nformat ascii 1.0\nend_header\n", "no triangle"),
        (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangle"),
        (b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "no sound"),
        (b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
    ] {
        let error = Mesh::decode(bytes).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
    // Counts are not believed.
    for count in ["5", "1000000000", "18446744073709551615"] {
        let huge = PLY.replace("element face 4", &format!("element face {count}"));
        assert!(Mesh::decode(huge.as_bytes()).is_err());
        let empty = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nelement face 0\nend_header\n"
        );
        assert!(Mesh::decode(empty.as_bytes()).is_err());
    }
}

#[test]
fn what_would_take_much_more_memory_than_the_file_is_not_read() {
    let ply = |element: &str, most: usize, property: &str, size: usize| {
        let head = format!(
            "ply\nformat binary_little_endian 1.0\nelement {element} {}\nproperty {property}\nend_header\n",
            most + 1
        );
        let mut file = head.into_bytes();
        file.resize(file.len() + size * (most + 1), 0);
        file
    };
    let mut obj = b"v 0 0 0\n".to_vec();
    (0..=MOST_TRIANGLES).for_each(|_| obj.extend(b"f 1 1 1\n"));
    for (file, words) in [
        (ply("vertex", MOST_VERTICES, "char x", 1), "30000000 vertices"),
        (ply("face", MOST_TRIANGLES, "list char char vertex_indices", 1), "10000000 faces"),
        (obj, "10000000 faces"),
    ] {
        let error = Mesh::decode(&file).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn no_bytes_do_harm() {
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 8
    };
    for seed in [
        PLY,
        OBJ,
        &PLY.replace("ascii", "binary_little_endian"),
        "v 1 2 3\nvn 0 0 1\nvt 0 1\nf 1/1/1 -1//1 1/1\n",
    ] {
        for _ in 0..3000 {
            let mut bytes = seed.as_bytes().to_vec();
            for _ in 0..1 + random() % 4 {
                let place = random() as usize % bytes.len();
                match random() % 3 {
                    0 => bytes[place] = (random() % 256) as u8,
                    1 => bytes[place] = b"0123456789-/. \n"[random() as usize % 15],
                    _ => bytes.truncate(place.max(1)),
                }
            }
            let _ = Mesh::decode(&bytes);
        }
    }
}
