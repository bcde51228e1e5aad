// All outputs of building_m2 at tau = 2.5, and the largest strain at the foot, from Rust.
use std::ffi::{c_char, c_int, CStr};

const OUTPUTS: usize = 6; // as in building_m2.h
const NAME: usize = 17;
const TAU_MAX: f64 = 12.0;

extern "C" {
    static building_m2_output_name: [[c_char; NAME]; OUTPUTS];
    fn building_m2_eval(tau: f64, out: *mut f64) -> c_int;
    fn building_m2_sample(tau0: f64, dtau: f64, count: usize, out: *mut f64) -> c_int;
}

fn main() {
    let mut out = [0.0; OUTPUTS];
    let mut rows = vec![0.0; OUTPUTS * 2001];
    // SAFETY: both arrays are as long as the header says
    let status = unsafe {
        building_m2_eval(2.5, out.as_mut_ptr())
            | building_m2_sample(0.0, TAU_MAX / 2000.0, 2001, rows.as_mut_ptr())
    };
    assert_eq!(status, 0);
    for (k, value) in out.iter().enumerate() {
        let name = unsafe { CStr::from_ptr(building_m2_output_name[k].as_ptr()) };
        println!("{} {:.12}", name.to_str().unwrap(), value);
    }
    println!("largest {:.12}", rows[..2001].iter().cloned().fold(f64::MIN, f64::max));
}
