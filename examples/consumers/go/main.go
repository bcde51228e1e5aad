// All outputs of building_m2 at tau = 2.5, and the largest strain at the foot, from Go.
package main

/*
#cgo CFLAGS: -O2 -I../building_m2
#include "building_m2.c"
*/
import "C"

import "fmt"

func main() {
	var out [C.BUILDING_M2_OUTPUTS]C.double
	rows := make([]C.double, len(out)*2001)
	step := C.double(C.BUILDING_M2_TAU_MAX) / 2000
	if C.building_m2_eval(2.5, &out[0]) != 0 || C.building_m2_sample(0, step, 2001, &rows[0]) != 0 {
		panic("a tau is out of range")
	}
	for k, value := range out {
		fmt.Printf("%s %.12g\n", C.GoString(&C.building_m2_output_name[k][0]), float64(value))
	}
	largest := rows[0]
	for _, value := range rows[:2001] {
		largest = max(largest, value)
	}
	fmt.Printf("largest %.12g\n", float64(largest))
}
