//! Videos: raw frames go to ffmpeg, which is a program of its own and may be missing.
//!
//! What it is told is fixed but for the size, the rate and the container; the scene has no say in it. It is started without a
//! shell, and writes to the file that is moved to its place when all went well.

use super::super::interrupt::Interrupt;
use super::super::{Problem, plain};
use rt_lang::output::animation::Reel;
use std::ffi::OsString;
use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Command, Stdio};
use std::thread::JoinHandle;

/// The program, which is looked for on the path.
const FFMPEG: &str = "ffmpeg";
/// How much of what it says is kept.
const MOST_SAID: u64 = 1 << 16;

/// A video that is being made.
pub struct Video {
    id: u32,
    frames: Option<ChildStdin>,
    /// The file that it writes.
    to: PathBuf,
    /// What it says on standard error.
    said: Option<JoinHandle<String>>,
    interrupt: Interrupt,
}

/// Makes sure that there is an ffmpeg, for a film of this name.
pub fn find(name: &str) -> Result<(), Problem> {
    let asked = Command::new(FFMPEG)
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match asked {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => {
            Err(Problem::new(format!("`{name}` is made by ffmpeg, which does not run here: {status}")))
        }
        Err(error) => {
            let reason = plain(&error);
            let problem = Problem::new(format!("`{name}` is made by ffmpeg, which cannot be run: {reason}"));
            Err(problem.help(
                "install ffmpeg; or make the film without it: `-o film.webp`, or pictures: `-o frame.{04}.png`",
            ))
        }
    }
}

/// Why videos of this size cannot be made, if they cannot: their colours have half the resolution.
pub fn refuse_odd([width, height]: [u32; 2]) -> Result<(), Problem> {
    if width % 2 == 0 && height % 2 == 0 {
        return Ok(());
    }
    let problem = Problem::new(format!("a video has an even width and height, and this is {width}×{height}"));
    Err(problem.help(format!(
        "such as `--size {}x{}`",
        width.next_multiple_of(2),
        height.next_multiple_of(2)
    )))
}

/// What ffmpeg is told.
///
/// Colours are those of BT.709, which sRGB shares its primaries and white with, said in the file; so players do not guess.
fn arguments(reel: &Reel, container: &str, to: &Path) -> Vec<OsString> {
    let [width, height] = reel.size;
    let mut arguments: Vec<OsString> =
        ["-nostdin", "-hide_banner", "-loglevel", "error"].map(OsString::from).into();
    let mut add = |words: &[&str]| arguments.extend(words.iter().map(OsString::from));
    add(&["-f", "rawvideo", "-pixel_format", "rgb24"]);
    add(&["-video_size", &format!("{width}x{height}"), "-framerate", &reel.rate.to_string()]);
    add(&["-i", "pipe:0", "-an"]);
    add(&["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"]);
    add(&[
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "iec61966-2-1",
        "-color_range",
        "tv",
    ]);
    if matches!(container, "mp4" | "mov") {
        // So that it plays before all of it has arrived.
        add(&["-movflags", "+faststart"]);
    }
    add(&["-f", container, "-y"]);
    // With the protocol said, no name is taken for another one.
    let mut file = OsString::from("file:");
    file.push(to);
    arguments.push(file);
    arguments
}

impl Video {
    /// Starts ffmpeg.
    pub fn begin(reel: &Reel, container: &str, to: &Path, interrupt: &Interrupt) -> Result<Video, Problem> {
        let mut command = Command::new(FFMPEG);
        command.args(arguments(reel, container, to));
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command
            .spawn()
            .map_err(|error| Problem::new(format!("ffmpeg cannot be run: {}", plain(&error))))?;
        let (frames, errors) = (child.stdin.take(), child.stderr.take());
        let id = interrupt.end_with(child);
        // It waits where nobody reads what it says.
        let read = move || {
            let mut said = vec![];
            if let Some(mut errors) = errors {
                let _ = errors.by_ref().take(MOST_SAID).read_to_end(&mut said);
                let _ = std::io::copy(&mut errors, &mut std::io::sink());
            }
            String::from_utf8_lossy(&said).into_owned()
        };
        let said = std::thread::Builder::new().spawn(read).ok();
        Ok(Video { id, frames, to: to.into(), said, interrupt: interrupt.clone() })
    }

    /// Sends a frame.
    pub fn add(&mut self, frame: &[u8]) -> Result<(), Problem> {
        let sent = self.frames.as_mut().map(|frames| frames.write_all(frame));
        match sent {
            Some(Ok(())) => Ok(()),
            // It is gone; how it went tells more than that.
            _ => self.end().and(Err(Problem::new("ffmpeg ended before the film did"))),
        }
    }

    /// Waits until the video is written.
    pub fn finish(mut self) -> Result<(), Problem> {
        self.end()?;
        match fs::metadata(&self.to) {
            Ok(written) if written.len() > 0 => Ok(()),
            Ok(_) => Err(failed("", "it has written nothing")),
            Err(error) => Err(failed("", &plain(&error))),
        }
    }

    fn end(&mut self) -> Result<(), Problem> {
        drop(self.frames.take());
        let status = self.interrupt.wait_for_child(self.id);
        let said = self.said.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        match status {
            Ok(Some(status)) if status.success() => Ok(()),
            Ok(Some(status)) => Err(failed(&said, &status.to_string())),
            Ok(None) => Err(failed(&said, "it is gone")),
            Err(error) => Err(failed(&said, &plain(&error))),
        }
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        // Not finished, so what it makes is not wanted.
        self.interrupt.end_child(self.id);
    }
}

/// In the last words of ffmpeg, or else by how it ended. Control characters of a file's name are not passed on.
fn failed(said: &str, status: &str) -> Problem {
    let last = said.lines().rev().map(str::trim).find(|line| !line.is_empty());
    let reason: String = last.unwrap_or(status).chars().filter(|c| !c.is_control()).take(300).collect();
    Problem::new(format!("ffmpeg could not make the film: {reason}"))
        .help("make pictures, which are whole in any case: `-o frame.{04}.png`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ffmpeg_is_told_what_the_frames_are() {
        let reel = Reel { size: [640, 480], transparent: false, frames: 2, rate: "23.976".parse().unwrap() };
        let told = arguments(&reel, "mp4", Path::new("/tmp/-a b;c.tmp"));
        let told: Vec<String> = told.into_iter().map(|word| word.into_string().unwrap()).collect();
        let has = |words: &[&str]| told.windows(words.len()).any(|window| window == words);
        assert!(has(&["-video_size", "640x480", "-framerate", "23976/1000", "-i", "pipe:0"]));
        assert!(has(&["-movflags", "+faststart"]) && has(&["-f", "mp4", "-y", "file:/tmp/-a b;c.tmp"]));
    }

    #[test]
    fn videos_are_even() {
        assert!(refuse_odd([640, 480]).is_ok());
        assert!(refuse_odd([641, 479]).is_err_and(|problem| problem.help.unwrap().contains("642x480")));
    }
}
