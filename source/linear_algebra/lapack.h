#pragma once

// What is called of BLAS and LAPACK directly, matrices by columns.

extern "C" {
void dpotrf_(const char *uplo, const int *n, double *A, const int *lda,
             int *info);
void dpotrs_(const char *uplo, const int *n, const int *nrhs, const double *A,
             const int *lda, double *b, const int *ldb, int *info);
void dgetrf_(const int *m, const int *n, double *A, const int *lda, int *pivots,
             int *info);
void dgetrs_(const char *transposed, const int *n, const int *columns,
             const double *A, const int *lda, const int *pivots, double *B,
             const int *ldb, int *info);
void dtrsm_(const char *side, const char *uplo, const char *transposed,
            const char *diagonal, const int *m, const int *n,
            const double *alpha, const double *A, const int *lda, double *B,
            const int *ldb);
void dtrsv_(const char *uplo, const char *transposed, const char *diagonal,
            const int *n, const double *A, const int *lda, double *x,
            const int *step);
void dsyrk_(const char *uplo, const char *transposed, const int *n,
            const int *k, const double *alpha, const double *A, const int *lda,
            const double *beta, double *C, const int *ldc);
void dgemm_(const char *transposed_a, const char *transposed_b, const int *m,
            const int *n, const int *k, const double *alpha, const double *A,
            const int *lda, const double *B, const int *ldb, const double *beta,
            double *C, const int *ldc);
void dsymv_(const char *uplo, const int *n, const double *alpha,
            const double *A, const int *lda, const double *x, const int *incx,
            const double *beta, double *y, const int *incy);
void dgemv_(const char *transposed, const int *m, const int *n,
            const double *alpha, const double *A, const int *lda,
            const double *x, const int *step_x, const double *beta, double *y,
            const int *step_y);
}
