/* Runs kernels on the first device of OpenCL: `host PROGRAM OPTIONS`, and from standard input

     new PARAMETERS NUMBERS KERNEL x...         makes the mechanism of its parameters
     run STATES INPUTS OUTPUTS KERNEL n x... m  calls a kernel: of each input its count and its numbers, of each output
                                                its count

   with numbers as bits in hexadecimal. Writes the outputs of a kernel as bits, one line a kernel. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void need(int holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "%s\n", what);
        exit(1);
    }
}

static double *numbers(size_t count)
{
    double *x = malloc((count + 1) * sizeof *x);
    need(x != NULL, "memory");
    for (size_t i = 0; i < count; i++) {
        unsigned long long bits;
        need(scanf("%llx", &bits) == 1, "a number");
        memcpy(x + i, &bits, sizeof bits);
    }
    return x;
}

static char *contents(const char *name)
{
    FILE *file = fopen(name, "rb");
    need(file != NULL && fseek(file, 0, SEEK_END) == 0, name);
    const long length = ftell(file);
    char *text = calloc((size_t)length + 1, 1);
    need(text != NULL && fseek(file, 0, SEEK_SET) == 0, name);
    need(fread(text, 1, (size_t)length, file) == (size_t)length, name);
    fclose(file);
    return text;
}

static cl_context context;
static cl_command_queue queue;
static cl_program program;

static cl_mem buffer(const double *x, size_t count)
{
    cl_int error;
    cl_mem memory = clCreateBuffer(context, CL_MEM_READ_WRITE, (count + 1) * sizeof *x, NULL, &error);
    need(error == CL_SUCCESS, "a buffer");
    if (x) {
        const size_t bytes = count * sizeof *x;
        need(clEnqueueWriteBuffer(queue, memory, CL_TRUE, 0, bytes, x, 0, NULL, NULL) == CL_SUCCESS, "a copy");
    }
    return memory;
}

static void set(cl_kernel kernel, cl_uint place, cl_mem memory)
{
    need(clSetKernelArg(kernel, place, sizeof memory, &memory) == CL_SUCCESS, "an argument");
}

static void run(cl_kernel kernel, size_t states)
{
    need(clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &states, NULL, 0, NULL, NULL) == CL_SUCCESS, "a run");
    need(clFinish(queue) == CL_SUCCESS, "its end");
}

static cl_kernel named(const char *name)
{
    cl_int error;
    cl_kernel kernel = clCreateKernel(program, name, &error);
    need(error == CL_SUCCESS, name);
    return kernel;
}

static cl_mem make(void)
{
    size_t parameters, length;
    char name[256];
    need(scanf("%zu %zu %255s", &parameters, &length, name) == 3, "new");
    double *x = numbers(parameters);
    cl_kernel kernel = named(name);
    cl_mem given = buffer(x, parameters), made = buffer(NULL, length);
    set(kernel, 0, given);
    set(kernel, 1, made);
    run(kernel, 1);
    clReleaseMemObject(given);
    clReleaseKernel(kernel);
    free(x);
    return made;
}

static void call(cl_mem self)
{
    cl_uint states;
    unsigned inputs, outputs;
    char name[256];
    need(scanf("%u %u %u %255s", &states, &inputs, &outputs, name) == 4, "run");
    need(inputs + outputs <= 16, "not so many arguments");
    cl_kernel kernel = named(name);
    cl_mem memory[16];
    size_t counts[16];
    need(clSetKernelArg(kernel, 0, sizeof states, &states) == CL_SUCCESS, "states");
    set(kernel, 1, self);
    for (unsigned i = 0; i < inputs + outputs; i++) {
        need(scanf("%zu", counts + i) == 1, "a count");
        double *x = i < inputs ? numbers(counts[i] * states) : NULL;
        memory[i] = buffer(x, counts[i] * states);
        set(kernel, i + 2, memory[i]);
        free(x);
    }
    run(kernel, states);
    for (unsigned i = 0; i < inputs + outputs; i++) {
        const size_t count = i < inputs ? 0 : counts[i] * states;
        unsigned long long *x = calloc(count + 1, sizeof *x);
        need(x != NULL, "memory");
        need(!count || clEnqueueReadBuffer(queue, memory[i], CL_TRUE, 0, count * 8, x, 0, NULL, NULL) == CL_SUCCESS,
             "a result");
        for (size_t k = 0; k < count; k++) {
            printf("%llx ", x[k]);
        }
        clReleaseMemObject(memory[i]);
        free(x);
    }
    printf("\n");
    clReleaseKernel(kernel);
}

int main(int argc, char **argv)
{
    cl_platform_id platform;
    cl_device_id device;
    cl_int error;
    need(argc > 2, "host PROGRAM OPTIONS");
    if (clGetPlatformIDs(1, &platform, NULL) || clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL)) {
        fprintf(stderr, "no device\n");
        return 77;
    }
    context = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
    need(error == CL_SUCCESS, "a context");
    queue = clCreateCommandQueue(context, device, 0, &error);
    need(error == CL_SUCCESS, "a queue");
    char *text = contents(argv[1]);
    program = clCreateProgramWithSource(context, 1, (const char **)&text, NULL, &error);
    need(error == CL_SUCCESS, "a program");
    if (clBuildProgram(program, 1, &device, argv[2], NULL, NULL) != CL_SUCCESS) {
        static char log[100000];
        clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, sizeof log - 1, log, NULL);
        fprintf(stderr, "%s\n", log);
        return 1;
    }
    cl_mem self = NULL;
    char command[16];
    while (scanf("%15s", command) == 1) {
        if (strcmp(command, "new") == 0) {
            self = make();
        } else {
            call(self);
        }
    }
    free(text);
    return 0;
}
