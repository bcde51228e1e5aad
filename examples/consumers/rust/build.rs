fn main() {
    println!("cargo:rerun-if-changed=../building_m2");
    cc::Build::new().file("../building_m2/building_m2.c").opt_level(2).compile("building_m2");
}
