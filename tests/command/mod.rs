//! The binary as its users run it: what it writes where, and how it ends.

mod animation;
mod bad_input;
mod denoise;
mod framing;
mod keeping;
mod layout;
mod lsp;
mod pictures;
mod places;
mod tools;
mod watch;
mod why;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// The least scene.
const BALL: &str = "sphere { radius: 1m }\n";

/// A folder with the scene `ball.rt`, in which the command runs.
pub struct Desk {
    folder: TempDir,
}

/// How the command ended and what it said.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Desk {
    pub fn new() -> Desk {
        let desk = Desk { folder: tempfile::tempdir().unwrap() };
        desk.put("ball.rt", BALL);
        desk
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub fn get(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// The names of what lies here, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The command, with arguments divided by spaces.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtc"));
        command.args(arguments.split_whitespace()).current_dir(self.folder.path()).stdin(Stdio::null());
        command
    }

    pub fn run(&self, arguments: &str) -> Ended {
        ended(self.command(arguments).output().unwrap())
    }

    /// Waits until a process has made this file.
    pub fn wait_for(&self, name: &str, child: &mut Child) {
        while fs::symlink_metadata(self.path(name)).is_err() {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Runs the command, and kills it so long after it has written this file anew. Whether it was not done by then.
    pub fn kill_after(&self, arguments: &str, file: &str, delay: Duration) -> bool {
        let written = || fs::read(self.path(file)).ok();
        let before = written();
        let mut child = self.command(arguments).stderr(Stdio::null()).spawn().unwrap();
        while written() == before && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(delay);
        child.kill().unwrap();
        !child.wait().unwrap().success()
    }

    /// Runs with a file on standard input.
    pub fn feed(&self, arguments: &str, file: &str) -> Ended {
        let stdin = fs::File::open(self.path(file)).unwrap();
        ended(self.command(arguments).stdin(stdin).output().unwrap())
    }

    /// Runs a build small enough to be over at once.
    pub fn quick(&self, arguments: &str) -> Ended {
        self.run(&format!("build --size 16x12 --samples 1 {arguments}"))
    }
}

fn ended(output: Output) -> Ended {
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(!stderr.contains("bug in rtc"), "{stderr}");
    Ended { code: output.status.code(), stdout: output.stdout, stderr }
}

impl Ended {
    /// Ended with this code, having said each of these, and nothing on standard output.
    #[track_caller]
    pub fn expect(&self, code: i32, said: &[&str]) {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        for words in said {
            assert!(self.stderr.contains(words), "no `{words}` in:\n{}", self.stderr);
        }
        assert!(self.stdout.is_empty(), "{:?}", String::from_utf8_lossy(&self.stdout));
    }
}

/// Size and bytes of a PNG.
pub fn read_png(file: &[u8]) -> ([u32; 2], Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    ([info.width, info.height], bytes)
}

#[test]
fn help_and_version_go_to_standard_output() {
    let desk = Desk::new();
    for (arguments, words) in [
        ("--help", "rtc build balls.rt"),
        ("-h", "rtc build balls.rt"),
        ("build --help", "--crop"),
        ("--version", "rtc "),
    ] {
        let ended = desk.run(arguments);
        assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""), "{arguments}");
        assert!(String::from_utf8(ended.stdout).unwrap().contains(words), "{arguments}");
    }
    desk.run("").expect(2, &["Usage: rtc"]);
    desk.run("bild ball.rt").expect(2, &["build"]);
}

#[test]
fn check_is_silent_on_a_good_scene_and_speaks_on_standard_error() {
    let desk = Desk::new();
    desk.run("check ball.rt").expect(0, &[]);
    assert_eq!(desk.feed("check -", "ball.rt").stderr, "");
    desk.put("bad.rt", "sphere { radius: 8deg }\n");
    desk.run("check ball.rt bad.rt").expect(1, &["E0203 ×", "[bad.rt:1:18]", "1 error in bad.rt"]);
    desk.run("check missing.rt bad.rt").expect(2, &["missing.rt", "1 error in bad.rt"]);
    assert_eq!(desk.names(), ["bad.rt", "ball.rt"]);
}

#[test]
fn text_that_is_piped_has_no_colours() {
    let desk = Desk::new();
    desk.put("bad.rt", "sphere { radius: 8deg }\n");
    assert!(!desk.run("check bad.rt").stderr.contains('\u{1b}'));
    let forced = desk.command("check bad.rt").env("CLICOLOR_FORCE", "1").output().unwrap();
    assert!(String::from_utf8(forced.stderr).unwrap().contains('\u{1b}'));
    let never =
        desk.command("check bad.rt").env("CLICOLOR_FORCE", "1").env("NO_COLOR", "1").output().unwrap();
    assert!(!String::from_utf8(never.stderr).unwrap().contains('\u{1b}'));
}

#[cfg(unix)]
#[test]
fn closed_pipes_are_no_panic() {
    let desk = Desk::new();
    desk.put("bad.rt", "sphere { radius: 8deg }\n");
    let rtc = env!("CARGO_BIN_EXE_rtc");
    for script in [
        "\"$0\" --help | true",
        "\"$0\" check bad.rt 2>&1 >/dev/null | true",
        "\"$0\" build ball.rt --size 64x64 --samples 1 -o - | true",
        "\"$0\" build ball.rt --size 64x64 --samples 1 -o exr:- >&-",
        "\"$0\" check bad.rt 2>&-",
    ] {
        let output = Command::new("sh").args(["-c", script, rtc]).current_dir(desk.folder.path()).output();
        let ended = ended(output.unwrap());
        assert!(!ended.stderr.contains("panic"), "{script}: {}", ended.stderr);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let desk = Desk::new();
    for arguments in ["build ball.rt --size 16x12 --samples 1 -o -", "--help"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = desk.command(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_build_ends_at_once_and_leaves_what_was_there() {
    let desk = Desk::new();
    for signal in ["INT", "TERM"] {
        desk.put("ball.png", "the picture of yesterday");
        let mut child = desk.command("build ball.rt --size 2000x2000 --samples 100000");
        let mut child = child.stderr(Stdio::piped()).spawn().unwrap();
        // Under way as soon as its file is there.
        while desk.names().len() < 3 {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(5));
        }
        let kill = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status();
        assert!(kill.unwrap().success());
        let start = std::time::Instant::now();
        let ended = ended(child.wait_with_output().unwrap());
        // The picture would take hours. How soon it ends is measured by `cargo bench --bench cancel`.
        assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
        ended.expect(130, &["interrupted"]);
        assert_eq!(desk.names(), ["ball.png", "ball.rt"]);
        assert_eq!(desk.get("ball.png"), b"the picture of yesterday");
    }
}

fn assert_same(path: &Path, other: &Path) {
    assert!(fs::read(path).unwrap() == fs::read(other).unwrap(), "{path:?} and {other:?} differ");
}
