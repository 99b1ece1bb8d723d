//! What is written is read again, and nothing else is.

use super::*;
use crate::color::Rgb;

fn identity() -> Identity {
    let value = |name: &str| {
        Some(match name {
            "size" => "40x20".to_string(),
            "crop" => "4,2,20,10".into(),
            "background" => "sky".into(),
            name => format!("{name} of the scene"),
        })
    };
    Identity::from_values(value).expect("every name has a value")
}

const WINDOW: Window = Window { x: 4, y: 2, width: 20, height: 10 };

const JUDGED: Option<Shown> = Some(Shown { stops: -0.1, tonemap: Tonemap::Agx });

/// A film of some samples of made-up light.
fn film(samples: Range<u32>) -> Film {
    let pixel = |index: usize| {
        let mut pixel = Pixel::default();
        for sample in samples.clone() {
            let v = f64::from((index as u32 * 7919 + sample * 104_729) % 1000) / 100.0;
            pixel.add(Rgb::new(v, -0.5 * v, 2.0), 1024.0);
            pixel.cover(sample % 3 == 0, 0.25);
        }
        pixel
    };
    let pixels = (0..WINDOW.pixels()).map(pixel).collect();
    Film::with_pixels(WINDOW, 1024.0, pixels).expect("as many as the window has")
}

fn saved(share: Option<Share>, samples: Range<u32>, aim: u32) -> Saved {
    let start = samples.start;
    let making = Making::resumed(film(samples), start, &[aim; 200], JUDGED).expect("all pixels are alike");
    let facts = Facts { stops: Some(0.5), seed: Some(7), ..Facts::unknown() };
    Saved { subject: Subject { program: "rtc 0".into(), identity: identity(), share }, making, facts }
}

/// The same with its first samples apart: `half` the last power of two of them, and that.
fn in_halves(saved: Saved, half: u32, last: u32) -> Saved {
    let early = [half, last].map(|samples| film(0..samples));
    let words = |which: usize, index: usize| Some(early[which].pixels()[index].light().words());
    let making = saved.making.with_early(words).expect("they are among its samples");
    Saved { making, ..saved }
}

fn bytes_of(saved: &Saved) -> Vec<u8> {
    saved.subject.encode(&saved.making, &saved.facts).expect("it can be written")
}

fn share(index: u32) -> Share {
    Share { index, of: 4, samples: 18 }
}

#[test]
fn what_is_written_is_read() {
    let apart = [
        in_halves(saved(None, 0..5, 9), 2, 4),
        in_halves(saved(None, 0..1, 1), 0, 1),
        in_halves(saved(None, 0..0, 3), 0, 0),
    ];
    let all = [saved(None, 0..5, 9), saved(Some(share(2)), 4..9, 5), saved(None, 0..0, 0)];
    for saved in all.into_iter().chain(apart) {
        let bytes = bytes_of(&saved);
        assert_eq!(Saved::decode(&bytes), Ok(saved.clone()));
        assert_eq!(bytes_of(&saved), bytes, "always the same bytes");
        let (shown, _) = crate::output::decode_exr(&bytes).expect("any program shows it");
        assert_eq!(shown, picture(saved.making.film(), &saved.subject.identity));
    }
}

#[test]
fn damaged_files_are_refused() {
    let bytes = bytes_of(&saved(None, 0..3, 3));
    for length in (0..bytes.len()).step_by(37) {
        assert!(Saved::decode(&bytes[..length]).is_err(), "cut to {length} bytes");
    }
    let mut random = 1u32;
    for _ in 0..2000 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let mut damaged = bytes.clone();
        let at = random as usize % bytes.len();
        damaged[at] ^= 1 << (random >> 29);
        // What is no sum, such as the colours that are shown, may differ.
        if let Ok(read) = Saved::decode(&damaged) {
            assert_eq!(read, saved(None, 0..3, 3), "byte {at}");
        }
    }
    for garbage in [&b""[..], b"sphere {}", &[0x76, 0x2f, 0x31, 0x01], &[0xff; 4096]] {
        assert!(Saved::decode(garbage).is_err());
    }
    let old = saved(None, 0..3, 3);
    let mut texts = old.subject.texts(&old.making);
    texts.iter_mut().filter(|(name, _)| name == FORM).for_each(|(_, value)| *value = "3".into());
    let channels = Channels { words: words(&old.making), texts, ..Channels::default() };
    let file = encode_exr(&picture(&film(0..1), &identity()), &Facts::unknown(), channels)
        .expect("it can be written");
    let why = Saved::decode(&file).expect_err("it is of an earlier form").to_string();
    assert!(why.contains("in form 3, and this version of rtc reads form 4 alone"), "{why}");
    let plain = encode_exr(&picture(&film(0..1), &identity()), &Facts::unknown(), Channels::default());
    let why = Saved::decode(&plain.expect("it can be written")).expect_err("it has no sums");
    assert!(why.to_string().contains("no exact sums"), "{why}");
}

/// The file with the numbers of one attribute of a box of pixels moved: the left and the right column by so many.
fn shifted(file: &[u8], attribute: &[u8], by: i32) -> Vec<u8> {
    let name = [attribute, b"\0box2i\0"].concat();
    let at = file.windows(name.len()).position(|bytes| bytes == name).expect("it is there") + name.len() + 4;
    let mut moved = file.to_vec();
    for column in [at, at + 8] {
        let bytes = moved[column..].first_chunk_mut::<4>().expect("a number of 32 bits");
        *bytes = (i32::from_le_bytes(*bytes) + by).to_le_bytes();
    }
    moved
}

#[test]
fn a_small_file_that_claims_many_pixels_is_refused_before_they_get_memory() {
    // A few pixels in the corner of a large picture, and then as if they were all of it.
    for ([width, height], why) in [([16_384, 8192], "cannot hold"), ([32_768, 32_768], "are allowed")] {
        let value = |name: &str| {
            Some(match name {
                "size" => format!("{width}x{height}"),
                "crop" => format!("0,0,{width},{height}"),
                name => format!("{name} of the scene"),
            })
        };
        let identity = Identity::from_values(value).expect("every name has a value");
        let subject = Subject { program: "rtc 0".into(), identity, share: None };
        let making = Making::new(Window::whole([4, 4]), 1.0);
        let file = subject.encode(&making, &Facts::unknown()).expect("it can be written");
        let name = b"dataWindow\0box2i\0";
        let at =
            file.windows(name.len()).position(|bytes| bytes == name).expect("it is there") + name.len() + 4;
        let mut claims = file.clone();
        claims[at + 8..at + 12].copy_from_slice(&(width - 1u32).to_le_bytes());
        claims[at + 12..at + 16].copy_from_slice(&(height - 1u32).to_le_bytes());
        let said = Saved::decode(&claims).expect_err("it is too small").to_string();
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn pixels_elsewhere_than_they_say_are_refused() {
    let bytes = bytes_of(&saved(Some(share(2)), 4..9, 5));
    assert!(Saved::decode(&shifted(&bytes, b"dataWindow", 0)).is_ok());
    // In the picture, partly or wholly to the right of it, to the left of it, and where no picture reaches.
    let elsewhere = "has its pixels elsewhere than in the crop that it says";
    for (by, said) in [
        (5, elsewhere),
        (-2, elsewhere),
        (17, elsewhere),
        (40, elsewhere),
        (-5, "cannot be read: its pixels lie outside of the picture"),
        (i32::MAX / 2, "cannot be read: it is damaged or cut short"),
    ] {
        let why = Saved::decode(&shifted(&bytes, b"dataWindow", by)).expect_err("they are elsewhere");
        assert_eq!(why.to_string(), said, "{by}");
    }
}

#[test]
fn a_head_is_judged_before_pixels_are_read() {
    let whole = saved(Some(share(2)), 4..9, 5);
    let bytes = bytes_of(&whole);
    let cut = |file: &[u8]| file[..file.len() - 200].to_vec();
    assert!(Saved::decode(&cut(&bytes)).is_err());
    let head = Head::decode(&cut(&bytes)).expect("the head is whole");
    assert_eq!((head.subject, head.facts), (whole.subject.clone(), whole.facts));
    let sums = || Channels {
        words: words(&whole.making),
        texts: whole.subject.texts(&whole.making),
        ..Channels::default()
    };
    let refuses = |channels: Channels, reason: &str| {
        let shown = picture(whole.making.film(), &whole.subject.identity);
        let file = encode_exr(&shown, &Facts::unknown(), channels).expect("it can be written");
        let why = Saved::decode(&cut(&file)).expect_err("it holds other things").to_string();
        assert!(why.contains(reason), "{why}");
    };
    refuses(Channels { texts: vec![], ..sums() }, "no exact sums");
    let plane = crate::output::Plane { name: "Z".into(), values: vec![0.0; 200] };
    refuses(Channels { planes: vec![plane], ..sums() }, "other channels");
    let halves = words(&in_halves(saved(None, 0..5, 5), 2, 4).making);
    assert_eq!(halves.len(), CHANNELS.len() + EARLY_CHANNELS.len());
    refuses(Channels { words: halves[..halves.len() - 1].to_vec(), ..sums() }, "other channels");
    let more = Words { name: "sums.more".into(), values: vec![0; 200] };
    refuses(Channels { words: [sums().words, vec![more]].concat(), ..sums() }, "other channels");
    refuses(Channels { words: sums().words.split_off(1), ..sums() }, "other channels");
}

#[test]
fn weights_of_all_samples_fit_their_sum() {
    let mut words = [0; WORDS];
    words[WORDS - 1] = MOST_SAMPLES;
    // The upper half of the weights of what is covered.
    words[WORDS - 4] = 1 << 31;
    assert_eq!(Pixel::from_words(words), None, "the least number there is");
    // Half of the samples with the most weight, twice.
    (words[WORDS - 4], words[WORDS - 1]) = (0x3fff_ffff, MOST_SAMPLES / 2);
    let half = Pixel::from_words(words).expect("so much can be");
    let mut sum = half;
    sum.merge(&half);
    assert_eq!(sum.samples(), MOST_SAMPLES);
}

#[test]
fn sums_that_cannot_be_are_refused() {
    let mut words = film(0..2).pixels()[0].words();
    assert!(Pixel::from_words(words).is_some());
    words[WORDS - 1] = 0;
    assert_eq!(Pixel::from_words(words), None, "light without samples");
    for most in [MOST_SAMPLES + 1, u32::MAX] {
        let mut none = [0; WORDS];
        none[WORDS - 1] = most;
        assert_eq!(Pixel::from_words(none), None);
    }
    for word in 0..WORDS - 1 {
        let mut large = [0; WORDS];
        (large[word | 1], large[WORDS - 1]) = (0x7fff_ffff, 1);
        // The upper half of a product comes two words behind.
        let products = 6..WORDS - 5;
        if products.contains(&word) {
            large[(word - 6) / 4 * 4 + 9] = 0x7fff_ffff;
        }
        assert_eq!(Pixel::from_words(large), None, "word {word}");
    }
}

#[test]
fn first_samples_that_are_none_of_all_are_refused() {
    let with = |change: &dyn Fn(&mut [u32; LIGHT_WORDS])| {
        let early = [2, 4].map(|samples| film(0..samples));
        let words = |which: usize, index: usize| {
            let mut words = early[which].pixels()[index].light().words();
            change(&mut words);
            Some(words)
        };
        saved(None, 0..5, 5).making.with_early(words)
    };
    assert!(with(&|_| ()).is_some());
    // Of each sum the upper half: more than 4 samples can have, and so little that the fifth would have too much.
    for word in (1..LIGHT_WORDS).step_by(2) {
        for wrong in [0x7fff_ffff, 0x8000_0000, 5 << 10, (-5i32 << 10) as u32] {
            assert_eq!(with(&|words| words[word] = wrong), None, "word {word}: {wrong:x}");
        }
    }
}

fn merged(order: &[u32]) -> Result<Merging, Refused> {
    let part = |index: u32| {
        let range = share(index).range();
        let aim = range.len() as u32;
        saved(Some(share(index)), range, aim)
    };
    let mut merging = Merging::new("first", part(order[0]))?;
    for index in &order[1..] {
        merging.add(&format!("part {index}"), &part(*index))?;
    }
    Ok(merging)
}

#[test]
fn shares_in_any_order_are_the_whole() {
    let ranges: Vec<Range<u32>> = (1..=4).map(|index| share(index).range()).collect();
    assert_eq!(ranges, [0..4, 4..9, 9..13, 13..18]);
    for order in [[1, 2, 3, 4], [4, 1, 3, 2]] {
        let merging = merged(&order).expect("they go together");
        assert_eq!((merging.film(), merging.missing()), (&film(0..18), vec![]));
    }
    assert_eq!(merged(&[3, 1]).expect("they go together").missing(), [2, 4]);
}

#[test]
fn what_does_not_go_together_is_named() {
    let twice = merged(&[1, 2, 1]).err().expect("one is there twice").to_string();
    assert_eq!(twice, "is share 1 of 4, and so is `first`");
    let mut merging = merged(&[1]).expect("one alone is a beginning");
    let mut add = |other: Saved| merging.add("other", &other).expect_err("it does not fit").to_string();
    assert!(add(saved(None, 4..9, 5)).contains("it is a checkpoint"));
    assert!(add(saved(Some(share(2)), 4..7, 5)).contains("not finished: it has 3 of its 5"));
    assert!(add(saved(Some(share(2)), 5..10, 5)).contains("other samples than its share"));
    let five = Share { index: 2, of: 5, samples: 18 };
    let why = add(saved(Some(five), five.range(), 4));
    assert_eq!(
        why,
        "does not go with `first`: its picture is of 18 samples in 5 shares, and that one of 18 samples in 4 shares"
    );
    let developed = |change: &dyn Fn(&mut Facts)| {
        let mut other = saved(Some(share(2)), 4..9, 5);
        change(&mut other.facts);
        other
    };
    let why = add(developed(&|facts| facts.stops = Some(4.0)));
    assert_eq!(why, "does not go with `first`: it is shown otherwise: `--exposure 0.5` (this share: 4)");
    let why = add(developed(&|facts| facts.tonemap = Some(Tonemap::Agx)));
    assert_eq!(why, "does not go with `first`: it is shown otherwise: `--tonemap none` (this share: agx)");
    assert!(add(developed(&|facts| facts.scene = Some("other".into()))).contains("of another scene"));
    let mut other = saved(Some(share(2)), 4..9, 5);
    other.subject.program = "rtc 99".into();
    assert!(add(other).contains("made by `rtc 99`, and this is rtc 0"));
    let values = |name: &str| {
        let own = identity();
        let value = own.entries().find(|(known, _)| *known == name).map(|(_, value)| value.to_string());
        if name == "seed" {
            Some("9".into())
        } else if name == "camera" {
            Some("".into())
        } else {
            value
        }
    };
    let foreign = Identity::from_values(values).expect("every name has a value");
    let mut other = saved(Some(share(2)), 4..9, 5);
    other.subject.identity = foreign;
    let why = add(other);
    let expected = "it is of another picture: another camera, `--seed seed of the scene` (this share: 9)";
    assert!(why.contains(expected), "{why}");
}

#[test]
fn those_of_which_most_are_there_come_first() {
    let head = |seed: &str, share: Option<Share>, finished: bool| {
        let value = |name: &str| {
            let own = identity();
            let value = own.entries().find(|(known, _)| *known == name).map(|(_, value)| value.to_string());
            if name == "seed" { Some(seed.to_string()) } else { value }
        };
        let samples = share.map_or(5, |share| share.range().len() as u32);
        let mut saved = saved(share, 0..4, 5);
        saved.facts.samples = finished.then_some([samples; 2]);
        saved.subject.identity = Identity::from_values(value).expect("every name has a value");
        Head::decode(&bytes_of(&saved)).ok()
    };
    // The picture, the number of the share, and whether that is finished.
    let named = |files: &[(char, u32, bool)]| -> Vec<Option<Head>> {
        let head = |(seed, index, finished): &(char, u32, bool)| match seed {
            '-' => None,
            'c' => head("1", None, *finished),
            _ => head(&seed.to_string(), Some(share(*index)), *finished),
        };
        files.iter().map(head).collect()
    };
    let heads = |seeds: &str| {
        let file = |(at, seed): (usize, char)| (seed, at as u32 % 4 + 1, true);
        named(&seeds.chars().enumerate().map(file).collect::<Vec<_>>())
    };
    assert_eq!(most_first(&heads("7111")), Ok(vec![1, 2, 3, 0]));
    assert_eq!(most_first(&heads("-c71-1")), Ok(vec![3, 5, 0, 1, 2, 4]));
    assert_eq!(most_first(&heads("71")), Err([0, 1]));
    assert_eq!(most_first(&heads("2711--7")), Err([1, 2]));
    // A share that is there again is one, and one that is finished counts for more than those that are not.
    let again = [('7', 1, true), ('7', 1, true), ('7', 1, true), ('1', 1, true), ('1', 2, true)];
    assert_eq!(most_first(&named(&again)), Ok(vec![3, 4, 0, 1, 2]));
    let unfinished = [('7', 1, false), ('7', 2, false), ('1', 3, true)];
    assert_eq!(most_first(&named(&unfinished)), Ok(vec![2, 0, 1]));
    assert_eq!(most_first(&named(&[('7', 1, false), ('1', 2, false), ('1', 3, false)])), Ok(vec![1, 2, 0]));
    assert_eq!(
        (most_first(&heads("1")), most_first(&heads("-")), most_first(&[])),
        (Ok(vec![0]), Ok(vec![0]), Ok(vec![]))
    );
}
