//! `@allow`: warnings that are expected.

use crate::check::Allow;
use crate::diagnostic::{Code, Diagnostic, Severity, any_errors};

/// Takes away the warnings that are allowed where they are: at a statement or inside it, or inside what it uses; of
/// those about two things, at either. Gives
/// a warning for each that allows nothing; none where there are errors, for these may hide what is allowed.
pub(crate) fn allow(allows: &[Allow], diagnostics: &mut Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut used = vec![false; allows.len()];
    let allowed = |allow: &Allow, warning: &Diagnostic| {
        let here = |span| allow.on.contains(span);
        allow.code == warning.code
            && (here(warning.primary.span)
                || warning.labels.iter().any(|other| here(other.span))
                || warning.uses.iter().any(|used| here(used.span)))
    };
    diagnostics.retain(|diagnostic| {
        let warning = diagnostic.severity() == Severity::Warning;
        let mut kept = true;
        for (allow, used) in allows.iter().zip(&mut used) {
            if warning && allowed(allow, diagnostic) {
                *used = true;
                kept = false;
            }
        }
        kept
    });
    if any_errors(diagnostics) {
        return vec![];
    }
    // What the renderer warns of is not known yet.
    let known = |allow: &Allow| !allow.code.as_str().starts_with("W07");
    let unused = allows.iter().zip(used).filter(|(allow, used)| !used && known(allow));
    unused.map(|(allow, _)| errors::unused(allow)).collect()
}

mod errors {
    use super::*;

    pub(super) fn unused(allow: &Allow) -> Diagnostic {
        let message = format!("there is no {} here to be allowed", allow.code.as_str());
        Diagnostic::new(Code::W0105, message, allow.span)
            .at("allows nothing")
            .help("remove it")
            .fix(allow.all, "")
    }
}
