//! Any file in place of a checkpoint or a share: what is read can be written again, and is then the same.

#![no_main]

use rt_lang::saved::Saved;

libfuzzer_sys::fuzz_target!(|file: &[u8]| {
    if let Ok(saved) = Saved::decode(file) {
        let again = saved.subject.encode(&saved.making, &saved.facts).expect("it was written before");
        assert_eq!(Saved::decode(&again), Ok(saved));
    }
});
