/** All outputs of building_m2 at tau = 2.5, and the largest strain at the foot, from Java. */
public final class Values {
    static native String[] names();

    static native double tauMax();

    static native boolean eval(double tau, double[] out);

    static native boolean sample(double tau0, double dtau, int count, double[] out);

    public static void main(String[] arguments) {
        System.load(java.nio.file.Path.of(arguments[0]).toAbsolutePath().toString());
        String[] names = names();
        double[] out = new double[names.length];
        double[] rows = new double[names.length * 2001];
        if (!eval(2.5, out) || !sample(0, tauMax() / 2000, 2001, rows)) {
            throw new IllegalArgumentException("a tau is out of range");
        }
        for (int k = 0; k < names.length; ++k) {
            System.out.printf(java.util.Locale.ROOT, "%s %.12f%n", names[k], out[k]);
        }
        double largest = java.util.Arrays.stream(rows, 0, 2001).max().getAsDouble();
        System.out.printf(java.util.Locale.ROOT, "largest %.12f%n", largest);
    }
}
