//! Cryptomatte: which things cover a pixel, and how much of it each.
//!
//! After Jonah Friedman and Andrew C. Jones, "Fully automatic ID mattes with support for motion blur and transparency",
//! SIGGRAPH 2015 talks, and the Cryptomatte specification, version 1.2.0: an id is the 32-bit MurmurHash3 of a name, taken for
//! a float; each pixel holds pairs of id and coverage, the largest first, two pairs to a layer of four channels; the header
//! holds how it was made, and the names with their ids.

use super::names::NameOf;
use crate::output::{Channels, Plane};
use crate::render::first::Firsts;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Pairs of id and coverage in a pixel.
const PAIRS: usize = 6;

/// Adds the layers of names to the channels of a picture.
pub(super) fn add(channels: &mut Channels, layer: &str, pixels: &[&Firsts], names: &NameOf) {
    let ids: BTreeMap<&str, u32> = names.values().map(|name| (name.as_str(), id(name))).collect();
    let ranked: Vec<[(f32, f32); PAIRS]> = pixels.par_iter().map(|firsts| rank(firsts, names)).collect();
    for pair in 0..PAIRS {
        let [name, coverage] = if pair % 2 == 0 { ["R", "G"] } else { ["B", "A"] };
        let at = |channel: &str| format!("{layer}{:02}.{channel}", pair / 2);
        let ids = ranked.iter().map(|pairs| pairs[pair].0).collect();
        let shares = ranked.iter().map(|pairs| pairs[pair].1).collect();
        channels.planes.push(Plane { name: at(name), values: ids });
        channels.planes.push(Plane { name: at(coverage), values: shares });
    }
    let key = format!("{:08x}", murmur3(layer.as_bytes()));
    let mut text = |field: &str, value: String| {
        channels.texts.push((format!("cryptomatte/{}/{field}", &key[..7]), value));
    };
    text("name", layer.into());
    text("hash", "MurmurHash3_32".into());
    text("conversion", "uint32_to_float32".into());
    text("manifest", manifest(&ids));
}

/// The names that cover a pixel, as ids with their shares, the largest first.
fn rank(firsts: &Firsts, names: &NameOf) -> [(f32, f32); PAIRS] {
    let mut shares: BTreeMap<u32, f64> = BTreeMap::new();
    for (primitive, share) in firsts.shown() {
        if let Some(name) = names.get(&primitive) {
            *shares.entry(id(name)).or_default() += share;
        }
    }
    let mut sorted: Vec<(u32, f64)> = shares.into_iter().collect();
    sorted.sort_by(|(a, x), (b, y)| y.total_cmp(x).then(a.cmp(b)));
    let mut pairs = [(0.0, 0.0); PAIRS];
    for (pair, (id, share)) in pairs.iter_mut().zip(sorted) {
        *pair = (f32::from_bits(id), share as f32);
    }
    pairs
}

/// The id of a name: its hash, with a bit changed where it would be no plain number as a float.
fn id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    match hash >> 23 & 0xff {
        0 | 0xff => hash ^ 1 << 23,
        _ => hash,
    }
}

/// MurmurHash3_x86_32 by Austin Appleby, with seed 0.
fn murmur3(bytes: &[u8]) -> u32 {
    let scrambled = |word: u32| word.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let mut hash = 0u32;
    let (words, tail) = bytes.as_chunks::<4>();
    for word in words {
        hash ^= scrambled(u32::from_le_bytes(*word));
        hash = hash.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    let rest = tail.iter().rev().fold(0, |rest, byte| rest << 8 | u32::from(*byte));
    hash ^= scrambled(rest);
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

/// Names with their ids as a JSON object in ASCII, which is all that a header surely keeps.
fn manifest(ids: &BTreeMap<&str, u32>) -> String {
    let mut text = String::from("{");
    for (name, id) in ids {
        let comma = if text.len() > 1 { "," } else { "" };
        let _ = write!(text, "{comma}\"");
        for unit in name.encode_utf16() {
            match u8::try_from(unit) {
                Ok(byte @ (b'"' | b'\\')) => {
                    let _ = write!(text, "\\{}", char::from(byte));
                }
                Ok(byte @ b' '..=b'~') => text.push(char::from(byte)),
                _ => {
                    let _ = write!(text, "\\u{unit:04x}");
                }
            }
        }
        let _ = write!(text, "\":\"{id:08x}\"");
    }
    text + "}"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_specification() {
        // From the reference implementation's tests, and from the specification's sample.
        assert_eq!(murmur3(b""), 0);
        assert_eq!(murmur3(b"hello"), 0x248b_fa47);
        assert_eq!(murmur3(b"hello, world"), 0x149b_bb7f);
        assert_eq!(murmur3(b"The quick brown fox jumps over the lazy dog"), 0x2e4f_f723);
        assert_eq!(id("bunny"), 0x13851a76);
    }

    #[test]
    fn every_id_is_a_plain_float() {
        for i in 0..100_000 {
            assert!(f32::from_bits(id(&format!("thing {i}"))).is_normal());
        }
    }

    #[test]
    fn names_of_any_letters_are_kept() {
        let ids = BTreeMap::from([("a\"\\\n", 1), ("vâse 🏺", 0xab)]);
        let object: serde_json::Value = serde_json::from_str(&manifest(&ids)).expect("it is JSON");
        assert_eq!(object["vâse 🏺"], "000000ab");
        assert_eq!(object["a\"\\\n"], "00000001");
        assert!(manifest(&ids).is_ascii());
    }
}
