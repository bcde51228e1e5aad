/* What Values.java calls: building_m2 by the names that JNI expects. */
#include "building_m2.h"

#include <jni.h>

JNIEXPORT jobjectArray JNICALL Java_Values_names(JNIEnv *env, jclass class)
{
    jobjectArray names = (*env)->NewObjectArray(env, BUILDING_M2_OUTPUTS, (*env)->FindClass(env, "java/lang/String"), NULL);
    (void)class;
    for (jsize k = 0; names != NULL && k < BUILDING_M2_OUTPUTS; ++k)
        (*env)->SetObjectArrayElement(env, names, k, (*env)->NewStringUTF(env, building_m2_output_name[k]));
    return names;
}

JNIEXPORT jdouble JNICALL Java_Values_tauMax(JNIEnv *env, jclass class)
{
    (void)env, (void)class;
    return BUILDING_M2_TAU_MAX;
}

JNIEXPORT jboolean JNICALL Java_Values_eval(JNIEnv *env, jclass class, jdouble tau, jdoubleArray out)
{
    jdouble *values = (*env)->GetDoubleArrayElements(env, out, NULL);
    const int status = building_m2_eval(tau, values);
    (void)class;
    (*env)->ReleaseDoubleArrayElements(env, out, values, 0);
    return status == 0;
}

JNIEXPORT jboolean JNICALL Java_Values_sample(JNIEnv *env, jclass class, jdouble tau0, jdouble dtau, jint count, jdoubleArray out)
{
    jdouble *values = (*env)->GetDoubleArrayElements(env, out, NULL);
    const int status = building_m2_sample(tau0, dtau, (size_t)count, values);
    (void)class;
    (*env)->ReleaseDoubleArrayElements(env, out, values, 0);
    return status == 0;
}
