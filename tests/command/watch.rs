//! `rtc watch`: whatever an editor does to a file, the picture that comes of it is that of a fresh build.

use super::Desk;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Much longer than anything here takes, also on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// What looks half written is not believed for a little longer than this.
const DOUBT: Duration = Duration::from_millis(450);

const FLAGS: &str = "--size 24x18 --samples 8";

const SCENE: &str = "\
camera { from: (0, 1, 4)m, look: (0, 0.5, 0)m, exposure: 0 }
light lamp { at: (2, 3, 2)m, power: 60W }
material glass = dielectric { ior: 1.5 }
param size: length = 50cm in 10cm to 90cm
plane { material: diffuse { color: #8a8f98 } }
sphere { at: (0, size, 0), radius: size, material: glass }
";

/// A command that follows `scene.rt`; it ends with this.
struct Watching<'d> {
    desk: &'d Desk,
    flags: &'static str,
    child: Child,
    lines: Receiver<String>,
    said: Vec<String>,
}

impl<'d> Watching<'d> {
    fn new(desk: &'d Desk) -> Watching<'d> {
        Watching::with(desk, FLAGS)
    }

    fn with(desk: &'d Desk, flags: &'static str) -> Watching<'d> {
        Watching::watch(desk, flags, "")
    }

    /// With flags that a build has too, and flags of its own.
    fn watch(desk: &'d Desk, flags: &'static str, own: &str) -> Watching<'d> {
        let mut command = desk.command(&format!("watch scene.rt -o out.exr {flags} {own}"));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let (sender, lines) = channel();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        std::thread::spawn(move || {
            stderr.lines().map_while(Result::ok).all(|line| sender.send(line).is_ok())
        });
        Watching { desk, flags, child, lines, said: vec![] }
    }

    /// Waits until it says something.
    #[track_caller]
    fn until(&mut self, wanted: &str) {
        let start = Instant::now();
        loop {
            match self.lines.recv_timeout(PATIENCE.saturating_sub(start.elapsed())) {
                Ok(line) => {
                    self.said.push(line);
                    if self.said.last().unwrap().contains(wanted) {
                        return;
                    }
                }
                Err(error) => panic!("it does not say `{wanted}` ({error}), but:\n{}", self.said.join("\n")),
            }
        }
    }

    /// Waits until the picture is that of a fresh build.
    #[track_caller]
    fn until_as_built(&mut self) {
        let fresh = self.desk.run(&format!("build scene.rt -o fresh.exr {}", self.flags));
        assert_eq!(fresh.code, Some(0), "{}", fresh.stderr);
        let wanted = self.desk.get("fresh.exr");
        let start = Instant::now();
        while fs::read(self.desk.path("out.exr")).ok().as_ref() != Some(&wanted) {
            assert!(start.elapsed() < PATIENCE, "another picture came of:\n{}", self.said.join("\n"));
            self.said.extend(self.lines.try_iter());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Saves files in several steps, none of which may be taken for the whole: once more where the machine was so busy that one
    /// may be. What was said meanwhile.
    #[track_caller]
    fn save(&mut self, steps: impl Fn()) -> String {
        loop {
            let start = Instant::now();
            steps();
            let in_time = start.elapsed() < DOUBT;
            self.until_as_built();
            let said = self.said();
            if in_time {
                assert!(!said.contains("error"), "what was being written was taken for the whole:\n{said}");
                return said;
            }
        }
    }

    /// Everything that was said since this was asked last.
    fn said(&mut self) -> String {
        self.said.extend(self.lines.try_iter());
        std::mem::take(&mut self.said).join("\n")
    }
}

impl Drop for Watching<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn desk() -> Desk {
    let desk = Desk::new();
    desk.put("scene.rt", SCENE);
    desk
}

/// The scene with a ball of another size.
fn with_size(size: &str) -> String {
    SCENE.replace("= 50cm", &format!("= {size}"))
}

#[test]
fn however_a_file_is_saved_the_picture_follows() {
    let desk = desk();
    let mut watching = Watching::new(&desk);
    watching.until_as_built();
    let scene = desk.path("scene.rt");

    // In place.
    watching.save(|| fs::write(&scene, with_size("40cm")).unwrap());
    // Emptied first, and filled a while later, in pieces.
    let text = with_size("41cm");
    watching.save(|| {
        fs::write(&scene, "").unwrap();
        std::thread::sleep(Duration::from_millis(60));
        fs::write(&scene, &text[..text.len() / 2]).unwrap();
        std::thread::sleep(Duration::from_millis(300));
        fs::write(&scene, &text).unwrap();
    });
    // Aside, then renamed.
    for size in ["42cm", "43cm"] {
        watching.save(|| {
            desk.put("scene.rt.tmp", with_size(size));
            fs::rename(desk.path("scene.rt.tmp"), &scene).unwrap();
        });
    }
    // The old one moved away first.
    watching.save(|| {
        fs::rename(&scene, desk.path("scene.rt~")).unwrap();
        fs::write(&scene, with_size("44cm")).unwrap();
        fs::remove_file(desk.path("scene.rt~")).unwrap();
    });
    // Removed, and made again.
    watching.save(|| {
        fs::remove_file(&scene).unwrap();
        std::thread::sleep(Duration::from_millis(100));
        fs::write(&scene, with_size("45cm")).unwrap();
    });
}

#[test]
fn nothing_that_a_scene_reads_is_taken_half_written() {
    let desk = desk();
    let part = |colour: &str| format!("sphere {{ at: (1, 1, 0)m, radius: 20cm }}\nlet paint = {colour}\n");
    let picture = |level: u8| {
        let mut file = vec![];
        let mut encoder = png::Encoder::new(&mut file, 64, 64);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[level; 64 * 64]).unwrap();
        file
    };
    desk.put("part.rt", part("#ff8800"));
    desk.put("paint.png", picture(90));
    let uses = "import \"part.rt\" as extra\nextra {}\n\
                disk { radius: 3m, at: (0, 0, -2)m, material: diffuse { color: image(\"paint.png\") } }\n";
    desk.put("scene.rt", format!("{SCENE}{uses}"));
    let mut watching = Watching::new(&desk);
    watching.until_as_built();
    let mut in_pieces = |name: &str, whole: &[u8]| {
        watching.save(|| {
            for length in [0, whole.len() / 3, whole.len() - 2] {
                desk.put(name, &whole[..length]);
                std::thread::sleep(Duration::from_millis(120));
            }
            desk.put(name, whole);
        })
    };
    in_pieces("part.rt", part("#0088ff").as_bytes());
    in_pieces("paint.png", &picture(200));
    // What stays whole is followed as well.
    desk.put("paint.png", picture(120));
    watching.until("`paint.png` changed: re-tracing");
    // What stays broken is told.
    desk.put("paint.png", &picture(200)[..40]);
    watching.until("paint.png");
}

#[test]
fn no_file_that_a_scene_reads_is_written_over() {
    let desk = desk();
    let floor = "disk { radius: 3m, at: (0, 0, -2)m, material: diffuse { color: image(\"out.exr\") } }\n";
    desk.run("build scene.rt -o out.exr --size 8x6 --samples 1").expect(0, &[]);
    let before = desk.get("out.exr");
    desk.put("scene.rt", format!("{SCENE}{floor}"));
    desk.run("build scene.rt -o out.exr --samples 1").expect(2, &["`out.exr` would be replaced"]);
    let mut watching = Watching::new(&desk);
    watching.until("`out.exr` would be replaced by the picture");
    assert_eq!(desk.get("out.exr"), before);
    desk.put("scene.rt", SCENE);
    watching.until_as_built();
}

#[test]
fn brighter_lamps_are_seen_at_once() {
    let desk = desk();
    let mut watching = Watching::new(&desk);
    watching.until("8 samples in");
    // What comes from which lamp is known a moment after a picture is done: longer on a machine that is slow or busy.
    for power in 20..30 {
        std::thread::sleep(Duration::from_millis(50) * (1 << (power - 20)));
        desk.put("scene.rt", SCENE.replace("60W", &format!("{power}W")));
        watching.until("`lamp.power` changed: re");
        if watching.said().contains("remixed at once, re-tracing, structure kept") {
            watching.until_as_built();
            return;
        }
        watching.until("8 samples in");
    }
    panic!("nothing was mixed anew");
}

#[cfg(unix)]
#[test]
fn links_that_are_swapped_are_followed() {
    use std::os::unix::fs::symlink;
    let desk = desk();
    fs::create_dir(desk.path("v1")).unwrap();
    fs::create_dir(desk.path("v2")).unwrap();
    desk.put("v1/scene.rt", with_size("30cm"));
    desk.put("v2/scene.rt", with_size("31cm"));
    fs::remove_file(desk.path("scene.rt")).unwrap();
    symlink("v1/scene.rt", desk.path("scene.rt")).unwrap();
    let mut watching = Watching::new(&desk);
    watching.until_as_built();
    symlink("v2/scene.rt", desk.path("next")).unwrap();
    fs::rename(desk.path("next"), desk.path("scene.rt")).unwrap();
    watching.until_as_built();
    desk.put("v2/scene.rt", with_size("32cm"));
    watching.until_as_built();
}

#[test]
fn files_can_be_looked_at_from_time_to_time() {
    let desk = desk();
    let mut watching = Watching::watch(&desk, FLAGS, "--poll=20");
    watching.until_as_built();
    for size in ["40cm", "41cm"] {
        desk.put("scene.rt", with_size(size));
        watching.until_as_built();
    }
}

#[test]
fn many_saves_end_in_the_last_one() {
    let desk = desk();
    let mut watching = Watching::new(&desk);
    watching.until_as_built();
    for i in 0..50 {
        desk.put("scene.rt", with_size(&format!("{}cm", 20 + i)));
        std::thread::sleep(Duration::from_millis(20));
    }
    watching.until_as_built();
}

#[test]
fn only_what_changed_is_done_again() {
    let desk = desk();
    let mut watching = Watching::new(&desk);
    watching.until("out.exr: 24×18, 8 samples");
    let mut save = |text: &str, wanted: &str| {
        desk.put("scene.rt", text);
        watching.until(wanted);
        watching.until_as_built();
    };
    save(&format!("// A ball.\n{SCENE}"), "the picture is the same, all samples kept");
    save(&SCENE.replace("exposure: 0", "exposure: 1"), "`camera.exposure` changed: developed anew, no ray");
    let glass = SCENE.replace("exposure: 0", "exposure: 1").replace("1.5", "1.45");
    save(&glass, "`glass.ior` changed: re-tracing, structure kept");
    let dim = glass.replace("60W", "30W");
    // Mixed at once, where it was known already what comes from which lamp.
    save(&dim, "`lamp.power` changed: re");
    let moved = dim.replace("(0, 1, 4)m", "(0, 1, 5)m");
    save(&moved, "`camera.from` changed: re-tracing");
    let smaller = moved.replace("= 50cm", "= 49cm");
    save(&smaller, "`size` changed: re-tracing");
    // Nothing at all. What is moved there is never seen half written.
    watching.said();
    desk.put("scene.rt.tmp", &smaller);
    fs::rename(desk.path("scene.rt.tmp"), desk.path("scene.rt")).unwrap();
    desk.put("another.rt", &smaller);
    std::thread::sleep(Duration::from_millis(200));
    assert!(!watching.said().contains("changed: "), "a save that changes nothing is nothing");
}

#[test]
fn any_edits_in_any_haste_end_as_a_fresh_build() {
    let desk = desk();
    let mut watching = Watching::new(&desk);
    let edits = [
        ("60W", "20W"),
        ("60W", "0W"),
        ("exposure: 0", "exposure: auto"),
        ("1.5", "1.6"),
        ("dielectric { ior: 1.5 }", "mirror {}"),
        ("= 50cm", "= 45cm"),
        ("(0, 1, 4)m", "(0, 2, 4)m"),
        ("plane", "// floor\nplane"),
        ("#8a8f98", "checker(#8a8f98, #223344, 20cm)"),
        ("radius: size", "raduis: size"),
        ("camera {", "render { seed: 3 }\ncamera {"),
    ];
    let mut random = 1u64;
    let mut below = |most: u64| {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 33) % most
    };
    for _ in 0..8 {
        let mut text = SCENE.to_string();
        for _ in 0..6 {
            let (from, to) = edits[below(edits.len() as u64) as usize];
            text = if text.contains(from) { text.replacen(from, to, 1) } else { SCENE.to_string() };
            desk.put("scene.rt", &text);
            std::thread::sleep(Duration::from_millis(below(40)));
        }
        text = text.replace("raduis", "radius");
        desk.put("scene.rt", &text);
        watching.until_as_built();
    }
}

#[test]
fn settings_of_the_picture_are_followed_too() {
    let desk = desk();
    let render = |settings: &str| format!("{SCENE}render {{ size: (24, 18), {settings} }}\n");
    desk.put("scene.rt", render("samples: 16"));
    let mut watching = Watching::with(&desk, "");
    watching.until_as_built();
    for settings in [
        "samples: 4",
        "samples: 40",
        "noise: 20%",
        "noise: 5%",
        "noise: 10%",
        "samples: 3, background: transparent",
        "samples: 3, seed: 2",
    ] {
        desk.put("scene.rt", render(settings));
        watching.until_as_built();
    }
    desk.put("scene.rt", render("samples: 4").replace("(24, 18)", "(30, 11)"));
    watching.until_as_built();
}

#[test]
fn errors_are_said_once_and_go() {
    let desk = desk();
    let mut watching = Watching::new(&desk);
    watching.until_as_built();
    let before = desk.get("out.exr");
    desk.put("scene.rt", SCENE.replace("radius", "raduis"));
    watching.until("raduis");
    assert_eq!(desk.get("out.exr"), before, "the last good picture stays");
    desk.put("scene.rt", SCENE);
    watching.until("no errors any more");
    watching.until_as_built();
}

#[test]
fn what_a_scene_imports_is_followed_also_where_it_is_missing() {
    let desk = desk();
    let uses = "import \"parts/lantern.rt\" as lantern\nlantern {}\n";
    desk.put("scene.rt", format!("{SCENE}{uses}"));
    let mut watching = Watching::new(&desk);
    watching.until("there is no file");
    fs::create_dir(desk.path("parts")).unwrap();
    std::thread::sleep(Duration::from_millis(50));
    desk.put("parts/lantern.rt", "sphere { at: (1, 1, 0)m, radius: 20cm }\n");
    watching.until("no errors any more");
    watching.until_as_built();
    desk.put("parts/lantern.rt", "sphere { at: (1, 1, 0)m, radius: 30cm }\n");
    watching.until_as_built();
    fs::remove_dir_all(desk.path("parts")).unwrap();
    watching.until("there is no file");
    // A folder that is made anew is another one.
    for size in ["25cm", "26cm"] {
        fs::create_dir_all(desk.path("parts")).unwrap();
        desk.put("parts/lantern.rt", format!("sphere {{ at: (1, 1, 0)m, radius: {size} }}\n"));
        watching.until_as_built();
    }
    fs::rename(desk.path("parts"), desk.path("old")).unwrap();
    fs::create_dir(desk.path("parts")).unwrap();
    desk.put("parts/lantern.rt", "sphere { at: (1, 1, 0)m, radius: 27cm }\n");
    watching.until_as_built();
    desk.put("parts/lantern.rt", "sphere { at: (1, 1, 0)m, radius: 28cm }\n");
    watching.until_as_built();
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let desk = desk();
    for (arguments, wanted) in [
        ("watch none.rt", "there is no file `none.rt`"),
        ("watch -", "standard input does not change"),
        ("watch .", "is a folder"),
        ("watch scene.rt -o -", "cannot go to standard output"),
        ("watch scene.rt -o none/a.png", "there is no folder `none`"),
        ("watch scene.rt -o scene.rt", "is no format of pictures"),
        ("watch scene.rt --serve=0.0.0.0:80", "can be reached by others"),
        ("watch scene.rt --serve=x", "an address of this machine"),
        ("watch scene.rt --open", "--serve"),
        ("watch scene.rt --poll=0", "--poll"),
    ] {
        let ended = desk.run(arguments);
        assert_eq!(ended.code, Some(2), "{arguments}: {}", ended.stderr);
        assert!(ended.stderr.contains(wanted), "{arguments}: {}", ended.stderr);
    }
}
