//! Films in one file, written frame by frame: animated PNG and animated WebP, both lossless and played in a loop.
//!
//! Only one frame is in memory at a time.

use super::{CannotEncode, Depth, Facts, Picture, displayed};
use std::borrow::Cow;
use std::fmt;
use std::io::{self, Seek, SeekFrom, Write};
use std::str::FromStr;

/// A format of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Animated PNG: 8 or 16 bits a channel.
    Apng,
    /// Animated WebP: 8 bits a channel.
    WebP,
}

/// Pictures a second, as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    frames: u16,
    seconds: u16,
}

impl Rate {
    /// So many frames in so many seconds; none beyond one frame in 100 s and 1000 in one.
    pub fn new(frames: u16, seconds: u16) -> Option<Rate> {
        let (count, time) = (u32::from(frames), u32::from(seconds));
        let fits = time > 0 && time <= 100 * count && count <= 1000 * time;
        fits.then_some(Rate { frames, seconds })
    }

    /// How many seconds so many frames last.
    pub fn seconds(self, frames: u32) -> f64 {
        f64::from(frames) * f64::from(self.seconds) / f64::from(self.frames)
    }

    /// When a frame begins, in milliseconds from the start, rounded: so a film does not drift where a frame does not last
    /// whole milliseconds.
    fn milliseconds(self, frame: u32) -> u64 {
        let (frames, seconds) = (u64::from(self.frames), u64::from(self.seconds));
        (u64::from(frame) * 1000 * seconds + frames / 2) / frames
    }
}

/// As `24`, `23.976` or `30000/1001`.
impl FromStr for Rate {
    type Err = ();

    fn from_str(text: &str) -> Result<Rate, ()> {
        let number = |text: &str| text.parse::<u16>().map_err(|_| ());
        let (frames, seconds) = match (text.split_once('/'), text.split_once('.')) {
            (Some((frames, seconds)), _) => (number(frames)?, number(seconds)?),
            (None, Some((whole, part))) if matches!(part.len(), 1..=3) => {
                let scale = [10, 100, 1000][part.len() - 1];
                let part = number(part)?;
                (
                    number(whole)?.checked_mul(scale).and_then(|whole| whole.checked_add(part)).ok_or(())?,
                    scale,
                )
            }
            (None, _) => (number(text)?, 1),
        };
        Rate::new(frames, seconds).ok_or(())
    }
}

/// As [`Rate::from_str`] takes it, and as ffmpeg does.
impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.seconds {
            1 => write!(f, "{}", self.frames),
            seconds => write!(f, "{}/{seconds}", self.frames),
        }
    }
}

/// What all frames of a film have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reel {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether what nothing covers is transparent.
    pub transparent: bool,
    /// How many frames there are, at least 1.
    pub frames: u32,
    /// How fast they follow each other.
    pub rate: Rate,
}

/// Why a film did not get further.
#[derive(Debug)]
pub enum CannotFilm {
    /// It cannot be written there.
    Write(io::Error),
    /// The format cannot hold it.
    Encode(CannotEncode),
}

impl From<io::Error> for CannotFilm {
    fn from(error: io::Error) -> CannotFilm {
        CannotFilm::Write(error)
    }
}

impl From<CannotEncode> for CannotFilm {
    fn from(error: CannotEncode) -> CannotFilm {
        CannotFilm::Encode(error)
    }
}

impl From<png::EncodingError> for CannotFilm {
    fn from(error: png::EncodingError) -> CannotFilm {
        match error {
            png::EncodingError::IoError(error) => CannotFilm::Write(error),
            other => CannotFilm::Encode(CannotEncode(other.to_string())),
        }
    }
}

impl Reel {
    /// The same picture as a frame of this film.
    fn frame<'p>(&self, picture: &'p Picture) -> Result<Cow<'p, Picture>, CannotEncode> {
        if picture.size != self.size {
            let ([width, height], [w, h]) = (picture.size, self.size);
            let reason = format!("all frames have one size, and {width}×{height} are not {w}×{h}");
            return Err(CannotEncode(reason));
        }
        match (self.transparent, &picture.alpha) {
            (true, None) => {
                let alpha = Some(vec![1.0; picture.pixels.len()]);
                Ok(Cow::Owned(Picture { alpha, ..picture.clone() }))
            }
            (false, Some(_)) => {
                Err(CannotEncode("a transparent frame is in a film whose first frame is not".into()))
            }
            _ => Ok(Cow::Borrowed(picture)),
        }
    }

    /// Red, green, blue and, where the film is transparent, alpha of a frame in a byte each, row by row from the top.
    ///
    /// # Errors
    ///
    /// If it is no frame of this film.
    pub fn raw(&self, picture: &Picture, facts: &Facts) -> Result<Vec<u8>, CannotEncode> {
        Ok(displayed::eight_bits(&*self.frame(picture)?, facts.developing()))
    }
}

/// A film that is being written.
pub enum Animation<W: Write + Seek> {
    /// As PNG.
    Apng(Reel, Depth, Box<png::Writer<W>>),
    /// As WebP.
    WebP(Reel, Riff<W>),
}

impl<W: Write + Seek> Animation<W> {
    /// Begins a film. `depth` matters to PNG alone.
    ///
    /// # Errors
    ///
    /// If it cannot be written, or the format holds no such frames.
    pub fn begin(motion: Motion, reel: Reel, depth: Depth, to: W) -> Result<Animation<W>, CannotFilm> {
        match motion {
            Motion::Apng => {
                let mut encoder = displayed::png_encoder(to, reel.size, reel.transparent, depth);
                encoder.set_animated(reel.frames, FOREVER)?;
                encoder.set_frame_delay(reel.rate.seconds, reel.rate.frames)?;
                Ok(Animation::Apng(reel, depth, Box::new(encoder.write_header()?)))
            }
            Motion::WebP => {
                super::Format::WebP.refuses(reel.size).map_or(Ok(()), Err)?;
                Ok(Animation::WebP(reel, Riff::begin(to, &reel)?))
            }
        }
    }

    /// Adds a frame.
    ///
    /// # Errors
    ///
    /// If it cannot be written, or is no frame of this film.
    pub fn add(&mut self, picture: &Picture, facts: &Facts) -> Result<(), CannotFilm> {
        let developing = facts.developing();
        match self {
            Animation::Apng(reel, depth, writer) => {
                let frame = reel.frame(picture)?;
                let bytes = match depth {
                    Depth::Eight => displayed::eight_bits(&frame, developing),
                    Depth::Sixteen => displayed::sixteen_bits(&frame, developing),
                };
                Ok(writer.write_image_data(&bytes)?)
            }
            Animation::WebP(reel, riff) => {
                let still = displayed::webp(&*reel.frame(picture)?, developing)?;
                riff.frame(reel, &still)
            }
        }
    }

    /// How many frames like those so far fit, where not all of them do.
    pub fn fitting(&self) -> Option<u32> {
        let Animation::WebP(reel, riff) = self else { return None };
        let a_frame = riff.length.div_ceil(u64::from(riff.frames.max(1)));
        let fitting = (u64::from(u32::MAX) - OUTSIDE) / a_frame.max(1);
        (fitting < u64::from(reel.frames)).then_some(fitting as u32)
    }

    /// Ends the film, after its last frame.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn finish(self) -> Result<(), CannotFilm> {
        match self {
            Animation::Apng(_, _, writer) => Ok(writer.finish()?),
            Animation::WebP(_, riff) => riff.finish(),
        }
    }
}

/// Plays of a film in a loop without end.
const FOREVER: u32 = 0;

/// An animated WebP: chunks in a RIFF file, of which each is a name, a 32-bit length and so many bytes.
///
/// Source: RFC 9649, "WebP Image Format" (2024), section 2.7.
pub struct Riff<W: Write + Seek> {
    to: W,
    /// Bytes written.
    length: u64,
    /// Frames written.
    frames: u32,
}

/// Bytes before those that the file's length counts.
const OUTSIDE: u64 = 8;

impl<W: Write + Seek> Riff<W> {
    fn begin(to: W, reel: &Reel) -> Result<Riff<W>, CannotFilm> {
        const ANIMATION: u8 = 0x02;
        const ALPHA: u8 = 0x10;
        let mut riff = Riff { to, length: 0, frames: 0 };
        // The length is put in at the end.
        riff.write(b"RIFF\0\0\0\0WEBP")?;
        let flags = ANIMATION | if reel.transparent { ALPHA } else { 0 };
        let mut canvas = vec![flags, 0, 0, 0];
        canvas.extend(reel.size.iter().flat_map(|side| three_bytes(side - 1)));
        riff.chunk(b"VP8X", &[&canvas])?;
        // The background, transparent black, which frames cover.
        let plays = (FOREVER as u16).to_le_bytes();
        riff.chunk(b"ANIM", &[&[0; 4], &plays])?;
        Ok(riff)
    }

    /// Adds a frame, which comes as the file of a still picture.
    fn frame(&mut self, reel: &Reel, still: &[u8]) -> Result<(), CannotFilm> {
        /// The frame replaces what was there.
        const DO_NOT_BLEND: u8 = 0x02;
        let image = lossless_chunk(still)
            .ok_or_else(|| CannotEncode("the frame just encoded cannot be read".into()))?;
        let lasts = reel.rate.milliseconds(self.frames + 1) - reel.rate.milliseconds(self.frames);
        let mut head = vec![0; 6];
        head.extend(reel.size.iter().flat_map(|side| three_bytes(side - 1)));
        head.extend(three_bytes(lasts as u32));
        head.push(DO_NOT_BLEND);
        self.chunk(b"ANMF", &[&head, image])?;
        self.frames += 1;
        Ok(())
    }

    fn finish(mut self) -> Result<(), CannotFilm> {
        let length = (self.length - OUTSIDE) as u32;
        self.to.seek(SeekFrom::Start(4))?;
        self.to.write_all(&length.to_le_bytes())?;
        Ok(self.to.flush()?)
    }

    fn chunk(&mut self, name: &[u8; 4], parts: &[&[u8]]) -> Result<(), CannotFilm> {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        if self.length + OUTSIDE + length as u64 + 1 > u64::from(u32::MAX) {
            return Err(CannotEncode("a WebP holds at most 4 GiB".into()).into());
        }
        self.write(name)?;
        self.write(&(length as u32).to_le_bytes())?;
        parts.iter().try_for_each(|part| self.write(part))?;
        // Chunks begin at even places.
        if length % 2 == 1 { self.write(&[0]) } else { Ok(()) }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), CannotFilm> {
        self.length += bytes.len() as u64;
        Ok(self.to.write_all(bytes)?)
    }
}

/// The lower three bytes, the least first.
fn three_bytes(n: u32) -> [u8; 3] {
    let [a, b, c, _] = n.to_le_bytes();
    [a, b, c]
}

/// The chunk with the pixels of a lossless WebP, its head and padding included.
fn lossless_chunk(file: &[u8]) -> Option<&[u8]> {
    let mut rest = file.get(12..)?;
    loop {
        let length = u32::from_le_bytes(*rest.get(4..)?.first_chunk()?) as usize;
        let (chunk, after) = rest.split_at_checked(8 + length + length % 2)?;
        if chunk.starts_with(b"VP8L") {
            return Some(chunk);
        }
        rest = after;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::AnimationDecoder;
    use std::io::Cursor;

    fn picture(frame: u32, transparent: bool) -> Picture {
        let pixels = (0..35).map(|i| [i as f32 / 35.0, frame as f32 / 5.0, 0.5]).collect();
        let alpha = transparent.then(|| (0..35).map(|i| i as f32 / 34.0).collect());
        Picture { size: [7, 5], offset: [0, 0], whole: [7, 5], pixels, alpha }
    }

    fn film(motion: Motion, depth: Depth, transparent: bool, rate: &str) -> Vec<u8> {
        let reel = Reel { size: [7, 5], transparent, frames: 4, rate: rate.parse().unwrap() };
        let mut file = Cursor::new(vec![]);
        let mut film = Animation::begin(motion, reel, depth, &mut file).unwrap();
        // A frame that happens to be covered whole is one all the same.
        (0..4).for_each(|i| film.add(&picture(i, transparent && i != 2), &Facts::unknown()).unwrap());
        film.finish().unwrap();
        file.into_inner()
    }

    fn still(frame: u32, transparent: bool) -> Vec<u8> {
        let reel = Reel { size: [7, 5], transparent, frames: 4, rate: Rate { frames: 1, seconds: 1 } };
        reel.raw(&picture(frame, transparent && frame != 2), &Facts::unknown()).unwrap()
    }

    #[test]
    fn an_animated_png_has_the_frames_and_their_times() {
        for transparent in [false, true] {
            let file = film(Motion::Apng, Depth::Eight, transparent, "30000/1001");
            let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
            assert_eq!(reader.info().animation_control().unwrap().num_plays, 0);
            assert_eq!(reader.info().animation_control().unwrap().num_frames, 4);
            for frame in 0..4 {
                let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
                reader.next_frame(&mut bytes).unwrap();
                assert_eq!(bytes, still(frame, transparent), "{frame}");
                let control = reader.info().frame_control().unwrap();
                assert_eq!((control.delay_num, control.delay_den), (1001, 30000));
            }
        }
    }

    #[test]
    fn an_animated_webp_has_the_frames_and_their_times() {
        for transparent in [false, true] {
            let file = film(Motion::WebP, Depth::Eight, transparent, "24");
            assert_eq!(u32::from_le_bytes(*file[4..].first_chunk().unwrap()) as usize + 8, file.len());
            let decoder = image::codecs::webp::WebPDecoder::new(Cursor::new(file)).unwrap();
            let frames = decoder.into_frames().collect_frames().unwrap();
            let times: Vec<u32> = frames.iter().map(|frame| frame.delay().numer_denom_ms().0).collect();
            assert_eq!(times, [42, 41, 42, 42], "167 ms in all, as four frames of 1/24 s");
            for (index, frame) in (0..).zip(&frames) {
                let channels = if transparent { 4 } else { 3 };
                let pixels: Vec<u8> =
                    frame.buffer().pixels().flat_map(|pixel| pixel.0[..channels].to_vec()).collect();
                assert_eq!(pixels, still(index, transparent), "{index}");
            }
        }
    }

    #[test]
    fn sixteen_bits_and_other_sizes() {
        let file = film(Motion::Apng, Depth::Sixteen, false, "25");
        assert_eq!(file[24], 16);
        let reel =
            Reel { size: [7, 6], transparent: false, frames: 1, rate: Rate { frames: 24, seconds: 1 } };
        for motion in [Motion::Apng, Motion::WebP] {
            let mut film = Animation::begin(motion, reel, Depth::Eight, Cursor::new(vec![])).unwrap();
            for wrong in [picture(0, false), Picture { size: [7, 6], ..picture(0, true) }] {
                assert!(matches!(film.add(&wrong, &Facts::unknown()), Err(CannotFilm::Encode(_))));
            }
        }
    }

    #[test]
    fn rates_are_read_strictly() {
        let read = |text: &str| text.parse::<Rate>().map(|rate| (rate.frames, rate.seconds));
        assert_eq!(
            (read("24"), read("23.976"), read("12.5")),
            (Ok((24, 1)), Ok((23976, 1000)), Ok((125, 10)))
        );
        assert_eq!((read("30000/1001"), read("0.01")), (Ok((30000, 1001)), Ok((1, 100))));
        for wrong in ["", "0", "-1", "1001", "0.001", "1/0", "24.", ".5", "nan", "1e3", "24.0001", "65536"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
        let rate: Rate = "24".parse().unwrap();
        assert_eq!((rate.milliseconds(24), rate.seconds(48), rate.to_string()), (1000, 2.0, "24".into()));
    }
}
