//! Two normal maps to one.

mod eight_bits;

use texbake::BlendMethod;

/// Every method but the masked blend.
fn every_method() -> [BlendMethod; 8] {
    use crate::support::weighted;
    let transition = BlendMethod::transition(crate::support::number("1/4")).expect("between 0 and 1");
    [
        BlendMethod::add(),
        weighted("3", "-2/7"),
        transition,
        BlendMethod::Linear,
        BlendMethod::Overlay,
        BlendMethod::Udn,
        BlendMethod::Whiteout,
        BlendMethod::Rnm,
    ]
}
